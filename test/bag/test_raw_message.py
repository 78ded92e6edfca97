# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of reading messages of raw bytes: as the library reads them, for any bytes."""

from bahrs_driver.bag.raw_message import read_raw
from bahrs_driver.errors import DamageError
from hypothesis import example, given, strategies as st
import numpy as np
import pytest
from rosbags.typesys import get_typestore, Stores

TYPE = 'std_msgs/msg/UInt8MultiArray'
STORE = get_typestore(Stores.ROS2_JAZZY)
MESSAGE, LAYOUT, DIMENSION = (STORE.types[f'std_msgs/msg/{name}'] for name in (
    'UInt8MultiArray', 'MultiArrayLayout', 'MultiArrayDimension'))

# Strings of CDR end at the first zero byte.
LABELS = st.lists(st.text(st.characters(exclude_characters='\0', exclude_categories=['Cs']),
                          max_size=9), max_size=3)


def serialized(labels, data, little_endian=True):
    """Return a serialized message."""
    layout = LAYOUT(dim=[DIMENSION(label=label, size=len(data), stride=1) for label in labels],
                    data_offset=0)
    return bytes(STORE.serialize_cdr(MESSAGE(layout=layout, data=np.frombuffer(data, np.uint8)),
                                     TYPE, little_endian=little_endian))


@given(LABELS, st.binary(max_size=20), st.booleans())
def test_label_and_data(labels, data, little_endian):
    """The first label counts; a message may have none."""
    message = serialized(labels, data, little_endian)
    assert read_raw(message) == (labels[0] if labels else None, data)


@given(LABELS, st.binary(max_size=20), st.lists(st.tuples(st.integers(0, 60), st.binary(
    min_size=1, max_size=4)), max_size=3), st.integers(0, 9))
@example(['a'], b'', [(4, b'\xff\xff\xff\xff')], 0)
def test_damaged_messages(labels, data, changes, cut):
    """What the library reads is read alike; anything else at most raises DamageError."""
    message = bytearray(serialized(labels, data))
    for place, change in changes:
        message[place:place + len(change)] = change
    message = bytes(message[:len(message) - cut])
    try:
        found = read_raw(message)
    except DamageError:
        found = None
    try:
        reference = STORE.deserialize_cdr(message, TYPE)
    except Exception:           # of many kinds
        return
    dimensions = reference.layout.dim
    assert found == (dimensions[0].label if dimensions else None, reference.data.tobytes())


def test_empty_message():
    """It is damaged."""
    with pytest.raises(DamageError, match='it is empty'):
        read_raw(b'')
