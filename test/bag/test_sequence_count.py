# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of counting missing messages by sequence numbers."""

from bahrs_driver.bag.sequence_count import missed, SequenceCount
from hypothesis import given, strategies as st

S = 1_000_000_000


def counted(numbers, period=5_000_000, begin=0, shared=False):
    """Return the count of a topic of which some messages were received, one per period in ns."""
    count = SequenceCount(lambda: shared)
    for number in numbers:
        count.add(number, begin + number * period)
    return count


def total(counts, recorder_start, driver_is_later):
    """Return the number of missed messages of all topics."""
    found = missed(dict(enumerate(counts)), recorder_start, driver_is_later)
    assert 0 not in found.values()
    return sum(found.values())


def test_nothing_lost():
    """All messages are received, from the first on."""
    count = counted(range(1, 100))
    assert (count.lost, total([count], 0, False), total([count], 0, True)) == (0, 0, 0)


def test_gaps_are_losses():
    """Missing numbers between received messages are losses."""
    assert counted([1, 2, 5, 6, 10]).lost == 2 + 3


def test_a_driver_that_was_started_later():
    """The topic with the most messages gives the estimate for all topics."""
    fast = counted(range(300, 500), begin=10 * S)
    slow = counted([3, 4], period=S, begin=10 * S)
    once = counted([2], begin=12 * S)
    assert total([fast, slow, once], 9 * S, False) == 299 + 2 + 1


def test_a_driver_that_ran_before():
    """Recording begins at discovery: no message is missed."""
    fast = counted(range(30_000, 31_000), begin=-150 * S)
    slow = counted([151, 152], period=S, begin=-150 * S)
    assert total([fast, slow], -S, False) == 0


def test_a_driver_that_certainly_started_later():
    """Its first messages are missed, even if too few give an estimate."""
    assert total([counted([5])], 0, False) == 0
    assert total([counted([5])], 0, True) == 4


def test_a_driver_that_was_restarted():
    """Its publishers count from 1, so their first messages are missed."""
    assert total([counted([*range(1, 50), 4, 5, 6])], 0, False) == 3


def test_several_publishers():
    """Their numbers show neither losses nor missed messages."""
    count = counted([7, 51, 8, 52, 9, 53], shared=True)
    assert (count.lost, total([count], 0, True)) == (0, 0)


def test_no_topics():
    """No message is missed."""
    assert total([], 0, False) == total([], 0, True) == 0


@given(first=st.integers(1, 5000), count=st.integers(10, 1000), age=st.integers(0, 100),
       period=st.integers(10 ** 6, 10 ** 8), lost=st.sets(st.integers(1, 900)))
def test_rates_of_any_kind(first, count, age, period, lost):
    """The driver started some seconds before the recorder, or after it."""
    numbers = [number for number in range(first, first + count) if number - first not in lost]
    topic = counted(numbers, period)
    since = age * S
    began, error = 0, 0.15 * first * period + 0.4 * S
    found = total([topic], since, False)
    assert found in (0, first - 1)
    if began > since + error:
        assert found == first - 1
    if began < since - error:
        assert found == 0 or first == 1
    assert topic.lost == len({number for number in lost if number + first < max(numbers)})
