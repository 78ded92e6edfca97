# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of counting samples, with literal counters; bounds are in periods."""

from bahrs_driver.clock.counter import SampleCounter
from bahrs_driver.protocol.bahrs.roles import ROLES
import pytest

PERIOD = ROLES.sample_period


def counted(*frames, latest=None):
    """Return the counts of frames, each given as its counter and its bound in periods."""
    counter, counts = SampleCounter(PERIOD), []
    for sequence, periods in frames:
        bound = round(periods * PERIOD)
        limit = None if latest is None else latest(periods)
        if not counter.advance(sequence, bound):
            counter.add(sequence, bound, limit)
        counts.append(counter.count)
    return counts


def test_in_order_over_the_end_of_the_counter():
    """The counter wraps from 255 to 0."""
    assert counted(*((i % 256, i) for i in range(250, 260))) == list(range(10))


@pytest.mark.parametrize('lost', [1, 2, 19, 100])
def test_lost_frames_are_counted(lost):
    """If enough time has passed."""
    assert counted((7, 0), ((8 + lost) % 256, 1 + lost)) == [0, 1 + lost]


@pytest.mark.parametrize('damaged', [7, 6, 200, 107])
def test_a_corrupted_counter_does_not_affect_the_next_frames(damaged):
    """Whether it is ahead or behind."""
    counts = counted((7, 0), (8, 1), (damaged, 2), (10, 3), (11, 4), latest=int)
    assert counts[:2] == [0, 1] and counts[3:] == [3, 4]
    assert counts[2] in (1, 2)


def test_the_next_counter_reveals_a_plausible_corrupted_one():
    """A late frame allows for one or two lost frames."""
    assert counted((7, 0), (8, 1), (11, 6), (10, 6), (11, 6), latest=int) == [0, 1, 4, 3, 4]


def test_a_repeated_frame():
    """It is the same sample."""
    assert counted((7, 0), (8, 1), (8, 1), (9, 2), latest=int) == [0, 1, 1, 2]


def test_three_implausible_counters_are_a_loss():
    """The device may have been restarted."""
    counter = SampleCounter(PERIOD)
    for index, sequence in enumerate((7, 107, 108, 109)):
        assert not counter.lost
        counter.add(sequence, index * PERIOD, index)
    assert counter.lost


def test_silence():
    """A silence of nearly the start-up time of a device."""
    counter = SampleCounter(PERIOD)
    assert not counter.silence_before(10 ** 12)
    counter.add(0, 0, None)
    assert not counter.silence_before(70 * PERIOD)
    assert counter.silence_before(90 * PERIOD)


@pytest.mark.parametrize('sequence, periods, far', [
    (1, 1, False), (20, 20, False), (40, 40, True), (40, 5, False), (250, 3, False)])
def test_far(sequence, periods, far):
    """If many samples are missing and enough time has passed, the device may have restarted."""
    counter = SampleCounter(PERIOD)
    assert not counter.is_far(sequence, 0, None)
    counter.add(0, 0, None)
    assert counter.is_far(sequence, periods * PERIOD, periods) is far


def test_nearest():
    """Time messages name samples near the latest one."""
    counter = SampleCounter(PERIOD)
    counter.add(250, 0, None)
    assert [counter.latest.nearest(sequence) for sequence in (250, 251, 249, 3, 130)] == [
        0, 1, -1, 9, -120]
