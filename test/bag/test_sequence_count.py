# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the messages that sequence numbers show as missing."""

from bahrs_driver.bag.sequence_count import missed, SequenceCount
from hypothesis import given, strategies as st

S = 1_000_000_000


def counted(numbers, period=5_000_000, begin=0, shared=False):
    """Return the count of a topic of which some messages came; the first was at a time in ns."""
    count = SequenceCount(lambda: shared)
    for number in numbers:
        count.add(number, begin + number * period)
    return count


def total(counts, since, is_new):
    """Return how many messages were missed of all topics."""
    found = missed(dict(enumerate(counts)), since, is_new)
    assert 0 not in found.values()
    return sum(found.values())


def test_nothing_lost():
    """From the first message on."""
    count = counted(range(1, 100))
    assert (count.lost, total([count], 0, False), total([count], 0, True)) == (0, 0, 0)


def test_gaps_are_losses():
    """Between messages that came."""
    assert counted([1, 2, 5, 6, 10]).lost == 2 + 3


def test_a_driver_that_was_started_later():
    """The rate of the fastest topic decides for rare topics, too."""
    fast = counted(range(300, 500), begin=10 * S)
    slow = counted([3, 4], period=S, begin=10 * S)
    once = counted([2], begin=12 * S)
    assert total([fast, slow, once], 9 * S, False) == 299 + 2 + 1


def test_a_driver_that_ran_before():
    """Recording begins where it finds the topics: nothing was missed."""
    fast = counted(range(30_000, 31_000), begin=-150 * S)
    slow = counted([151, 152], period=S, begin=-150 * S)
    assert total([fast, slow], -S, False) == 0


def test_a_driver_that_certainly_was_not_there():
    """Its first messages count, however few came."""
    assert total([counted([5])], 0, False) == 0
    assert total([counted([5])], 0, True) == 4


def test_a_driver_that_was_started_again():
    """Its publishers count from 1 again."""
    assert total([counted([*range(1, 50), 4, 5, 6])], 0, False) == 3


def test_several_publishers():
    """Their numbers say nothing."""
    count = counted([7, 51, 8, 52, 9, 53], shared=True)
    assert (count.lost, total([count], 0, True)) == (0, 0)


def test_no_topics():
    """Nothing was missed."""
    assert total([], 0, False) == total([], 0, True) == 0


@given(first=st.integers(1, 5000), count=st.integers(10, 1000), age=st.integers(0, 100),
       period=st.integers(10 ** 6, 10 ** 8), lost=st.sets(st.integers(1, 900)))
def test_rates_of_any_kind(first, count, age, period, lost):
    """The driver began some seconds before the recorder, or after it."""
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
