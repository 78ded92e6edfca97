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


def test_counts_continue_when_the_counter_wraps():
    """The counter wraps from 255 to 0."""
    assert counted(*((i % 256, i) for i in range(250, 260))) == list(range(10))


@pytest.mark.parametrize('lost', [1, 2, 19, 100])
def test_lost_frames_are_counted(lost):
    """Enough time has passed for them."""
    assert counted((7, 0), ((8 + lost) % 256, 1 + lost)) == [0, 1 + lost]


@pytest.mark.parametrize('damaged', [7, 6, 200, 107])
def test_a_corrupted_counter_does_not_affect_the_next_frames(damaged):
    """The corrupted counter is ahead or behind."""
    counts = counted((7, 0), (8, 1), (damaged, 2), (10, 3), (11, 4), latest=int)
    assert counts[:2] == [0, 1] and counts[3:] == [3, 4]
    assert counts[2] in (1, 2)


def test_the_next_counter_reveals_a_plausible_corrupted_one():
    """A late frame allows for one or two lost frames."""
    assert counted((7, 0), (8, 1), (11, 6), (10, 6), (11, 6), latest=int) == [0, 1, 4, 3, 4]


def test_a_repeated_frame_has_the_same_count():
    """It contains the same sample."""
    assert counted((7, 0), (8, 1), (8, 1), (9, 2), latest=int) == [0, 1, 1, 2]


def test_the_count_is_lost_after_three_implausible_counters():
    """The device may have been restarted."""
    counter = SampleCounter(PERIOD)
    for index, sequence in enumerate((7, 107, 108, 109)):
        assert not counter.lost
        counter.add(sequence, index * PERIOD, index)
    assert counter.lost


def test_silence_in_which_the_counter_may_wrap():
    """The shortest one is a little shorter than the start-up of a device."""
    counter = SampleCounter(PERIOD)
    assert not counter.silence_before(10 ** 12)
    counter.add(0, 0, None)
    assert not counter.silence_before(70 * PERIOD)
    assert counter.silence_before(90 * PERIOD)


@pytest.mark.parametrize('sequence, periods, far', [
    (1, 1, False), (20, 20, False), (40, 40, True), (40, 5, False), (250, 3, False)])
def test_missing_samples_after_which_the_device_may_have_restarted(sequence, periods, far):
    """Many samples are missing, and enough time has passed."""
    counter = SampleCounter(PERIOD)
    assert not counter.is_far(sequence, 0, None)
    counter.add(0, 0, None)
    assert counter.is_far(sequence, periods * PERIOD, periods) is far


def test_count_nearest_to_the_latest_sample():
    """Time messages name samples near the latest one."""
    counter = SampleCounter(PERIOD)
    counter.add(250, 0, None)
    assert [counter.latest.nearest(sequence) for sequence in (250, 251, 249, 3, 130)] == [
        0, 1, -1, 9, -120]
