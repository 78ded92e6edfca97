# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of sorting a stream by log times."""

from bahrs_driver.bag.reorder_buffer import ReorderBuffer
from hypothesis import given, strategies as st


def test_items_are_held_until_no_earlier_one_is_expected():
    """Items of equal log times keep their order."""
    buffer = ReorderBuffer()
    buffer.add([(20, 'b'), (10, 'a')])
    buffer.add([(20, 'c'), (20, 'd'), (30, 'e')])
    assert buffer.pop_until(9) == []
    assert buffer.pop_until(20) == [(10, 'a'), (20, 'b'), (20, 'c'), (20, 'd')]
    assert len(buffer) == 1
    assert buffer.pop_until() == [(30, 'e')]


def test_an_item_that_is_too_late():
    """It gets the log time of the one before it."""
    buffer = ReorderBuffer()
    buffer.add([(10, 'a')])
    assert buffer.pop_until(10) == [(10, 'a')]
    buffer.add([(5, 'b')])
    assert buffer.pop_until(10) == [(10, 'b')]


@given(st.lists(st.tuples(st.integers(-9, 99), st.integers(-9, 99))), st.integers(0, 5))
def test_order_and_number(steps, limit):
    """Log times never decrease, no more items than the limit are held, and none is lost."""
    buffer, found = ReorderBuffer(limit), []
    for number, (log_ns, until) in enumerate(steps):
        buffer.add([(log_ns, number)])
        found += buffer.pop_until(until)
        assert len(buffer) == number + 1 - len(found) <= limit
    found += buffer.pop_until()
    assert sorted(number for _, number in found) == [*range(len(steps))]
    assert [time for time, _ in found] == sorted(time for time, _ in found)
