# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The columns have the values of the messages, wherever blocks are cut."""

import struct

from bahrs_driver.convert import values
from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.message_objects import is_installed, to_message
from bahrs_driver.tables.column import table_columns
from bahrs_driver.tables.memory_sink import MemorySink
from bahrs_driver.tables.row_buffer import is_constant, RowBuffer
from hypothesis import given, strategies as st
import numpy as np
import pytest
from support.flat_messages import flat
from support.layout_values import values_of

# Of the installed types, whose message objects are the reference.
EVERY = pytest.mark.parametrize('kind', [
    kind for kind, layout in LAYOUTS.items() if is_installed(layout)],
    ids=lambda kind: kind.__name__)
TIMES = st.integers(0, 2 ** 62)


def bits(value):
    """Return a value that equals itself even if it is NaN, and differs for -0.0."""
    return struct.pack('d', value) if isinstance(value, float) else value


def table_of(kind, rows, cuts=()):
    """Return the table of messages, cut into blocks behind some rows."""
    buffer, sink = RowBuffer(kind), MemorySink(kind)
    for number, row in enumerate(rows):
        buffer.extend([row])
        if number in cuts or number == len(rows) - 1:
            sink.write(buffer.take())
    return sink.table()


@EVERY
@given(st.data())
def test_columns_are_the_fields_of_the_messages(kind, data):
    """Names, values and order, with any cuts; repeated rows make constant columns likely."""
    different = data.draw(st.lists(st.tuples(TIMES, values_of(kind)), min_size=1, max_size=3))
    rows = data.draw(st.lists(st.sampled_from(different), max_size=6))
    table = table_of(kind, rows, data.draw(st.sets(st.integers(0, 5))))
    names = [name for name, _ in flat(to_message(different[0][1]))]
    assert list(table) == ['time_ns', *names]
    assert {len(column) for column in table.values()} == {len(rows)} == {table.rows}
    expected = [[bits(value) for value in (time_ns, *(item for _, item in flat(to_message(row))))]
                for time_ns, row in rows]
    found = zip(*(map(bits, column.tolist()) for column in table.values()))
    assert list(map(list, found)) == expected


@EVERY
def test_columns_without_rows(kind):
    """They have the same types as those with rows."""
    empty = table_of(kind, [])
    assert [column.dtype for column in empty.values()] == [
        np.dtype(column.dtype) for column in table_columns(kind)]
    assert empty.rows == 0 and list(empty.units) == list(empty)


def pressure(index, value):
    """Return a row of a table of pressures."""
    return index, values.FluidPressure(10 ** 9 + index, 'imu_link', value, 4.0)


@pytest.mark.parametrize('length, cuts', [(1, ()), (2, ()), (5, (1,)), (5, (0, 1, 2, 3))])
def test_a_constant_column_has_one_element(length, cuts):
    """Even if its blocks have one row each."""
    table = table_of(values.FluidPressure, [pressure(i, float(i)) for i in range(length)], cuts)
    assert {name for name, column in table.items() if not is_constant(column)} == (
        {'time_ns', 'header.stamp.nanosec', 'fluid_pressure'} if length > 1 else set())
    assert table['variance'].tolist() == [4.0] * length


def test_columns_are_read_only():
    """Constant ones could not be written to; the others are alike."""
    table = table_of(values.FluidPressure, [pressure(i, float(i)) for i in range(3)])
    for column in table.values():
        with pytest.raises(ValueError, match='read-only'):
            column[0] = column[1]


def test_number_that_does_not_fit_is_an_error():
    """As it is when the message is serialized."""
    row = values.NavSatFix(0, '', 128, 0, 0.0, 0.0, 0.0, (0.0,) * 9, 0)
    with pytest.raises(OverflowError):
        RowBuffer(values.NavSatFix).extend([(0, row)])


def test_stack():
    """Members of a vector, a quaternion or a covariance, in the order of the message."""
    pose = values.height_pose(1, 'odom', 5.0, 0.5)
    table = table_of(values.PoseWithCovarianceStamped, [(1, pose), (2, pose)])
    assert table.stack('pose.pose.position').tolist() == [[0.0, 0.0, 5.0]] * 2
    assert table.stack('pose.pose.orientation').tolist() == [[0.0, 0.0, 0.0, 1.0]] * 2
    assert table.stack('pose.covariance').shape == (2, 36)
    assert table.stack('pose.covariance')[0].tolist() == list(pose.covariance)
    for absent in ('pose', 'header', 'orientation'):
        with pytest.raises(KeyError, match=absent):
            table.stack(absent)


def test_the_text_of_a_table_is_short():
    """An interactive session shows what there is, not all arrays."""
    table = table_of(values.Float64, [(1, values.Float64(5.0))] * 1200)
    assert repr(table) == '<table of std_msgs/msg/Float64: 1,200 rows, 2 columns>'
