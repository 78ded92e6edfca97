# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Serialized messages are those of rclpy, for any values."""

import math
import struct

from bahrs_driver.convert.values import TFMessage
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.message_layout import MessageLayout
from bahrs_driver.ros_layout.message_objects import is_installed, matches, message_type, to_message
from bahrs_driver.ros_layout.rows import data, number, records, text
from bahrs_driver.ros_layout.sequence_layout import SequenceLayout
from bahrs_driver.units import NS_PER_S
from hypothesis import given, strategies as st
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import get_typestore, Stores
from support.layout_values import values_of

# ROS from wheels has no tf2_msgs.
EVERY = pytest.mark.parametrize('kind', [kind if is_installed(layout) else pytest.param(
    kind, marks=pytest.mark.skip(f'{layout.name} is not installed'))
    for kind, layout in LAYOUTS.items()], ids=lambda kind: kind.__name__)
STORE = get_typestore(Stores.ROS2_JAZZY)


@EVERY
@given(st.data())
def test_bytes_are_those_of_rclpy(kind, data):
    """In size and in every field; rclpy leaves padding as it was."""
    values = data.draw(values_of(kind))
    message = to_message(values)
    own, reference = LAYOUTS[kind].serialize(values), serialize_message(message)
    assert len(own) == len(reference) and own[:4] == reference[:4]
    received = deserialize_message(own, type(message))
    # Compared as bytes, in which NaN equals itself.
    assert flat(received) == flat(message) == flat(deserialize_message(reference, type(message)))


@given(values_of(TFMessage))
def test_bytes_of_transforms_are_those_of_rosbags(values):
    """Which knows tf2_msgs where ROS does not."""
    name = LAYOUTS[TFMessage].name
    own = LAYOUTS[TFMessage].serialize(values)
    message = STORE.deserialize_cdr(own, name)
    assert bytes(STORE.serialize_cdr(message, name)) == own
    for transform, record in zip(message.transforms, values.transforms, strict=True):
        stamp_ns, frame_id, child_frame_id, *numbers = record
        stamp, pose = transform.header.stamp, transform.transform
        assert (stamp.sec * NS_PER_S + stamp.nanosec, transform.header.frame_id,
                transform.child_frame_id) == (stamp_ns, frame_id, child_frame_id)
        fields = [*(getattr(pose.translation, name) for name in 'xyz'),
                  *(getattr(pose.rotation, name) for name in 'xyzw')]
        assert struct.pack('7d', *fields) == struct.pack('7d', *numbers[0], *numbers[1])


def flat(value):
    """Return all values of a message, numbers as their bytes."""
    if hasattr(value, 'get_fields_and_field_types'):
        return [flat(getattr(value, name)) for name in value.get_fields_and_field_types()]
    if isinstance(value, float):
        return struct.pack('d', value)
    if isinstance(value, list):
        return list(map(flat, value))
    return value.tobytes() if hasattr(value, 'tobytes') else value


@EVERY
def test_layout_has_the_fields_of_the_definition(kind):
    """Names, types and order; the values have one for each row."""
    assert matches(LAYOUTS[kind])
    assert len(kind._fields) == len(LAYOUTS[kind].rows)
    assert message_type(kind).__name__ == kind.__name__


@pytest.mark.parametrize('rows', [
    (), (number('data', 'i'),), (number('other', 'd'),),
    (number('data', 'd'), number('more', 'd'))])
def test_another_definition_does_not_match(rows):
    """For example a field that a later version of ROS adds."""
    assert not matches(MessageLayout('std_msgs/msg/Float64', *rows))


@pytest.mark.parametrize('dimension', [
    (), (text('label'), number('size', 'I')), (text('label'), data('size'), data('stride')),
    (text('label'), number('stride', 'I'), number('size', 'I'))])
def test_another_definition_of_an_element_does_not_match(dimension):
    """Elements of sequences are compared, too."""
    assert not matches(SequenceLayout(
        'std_msgs/msg/UInt8MultiArray',
        records('layout.dim', 'std_msgs/msg/MultiArrayDimension', *dimension),
        number('layout.data_offset', 'I'), data('data')))


def test_every_topic_has_a_layout():
    """Of any device."""
    assert {kind for spec in DEVICES.values() for kind in spec.topics().values()} <= set(LAYOUTS)


def test_number_that_does_not_fit_is_an_error():
    """A time beyond 2038, for example."""
    kind = next(iter(LAYOUTS))
    values = kind(2 ** 31 * 10 ** 9, '', *(
        (math.nan,) * row.length for row in LAYOUTS[kind].rows[2:]))
    with pytest.raises(struct.error):
        LAYOUTS[kind].serialize(values)
