# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the tracker and its filter, with literal pairs of device time and bound."""

import random
from statistics import median

from bahrs_driver.clock.estimation.kalman import OffsetFilter, process_model
from bahrs_driver.clock.estimation.tracker import Tracker
import pytest

PERIOD = 5_000_000
OFFSET = 10 ** 15
SECOND = 200            # samples


def fed(delays, skew=0.0, tracker=None, start=0):
    """Return a tracker after samples with these delays in us."""
    tracker = tracker or Tracker()
    for index, delay in enumerate(delays, start):
        device = index * PERIOD
        tracker.feed(device, OFFSET + round(device * (1 + skew)) + round(delay * 1000))
    return tracker


def error(tracker, count, skew=0.0):
    """Return the error of the host time at a count, in us."""
    device = count * PERIOD
    return (tracker.host_time(device) - OFFSET - round(device * (1 + skew))) / 1000


def noise(count, seed=1):
    """Return delays from 0 to 8 ms, like those of an adapter."""
    source = random.Random(seed)
    return [source.uniform(0, 8000) for _ in range(count)]


def test_the_first_estimate_is_the_bound_of_the_first_sample():
    """No other sample is known."""
    assert error(fed([70]), 0) == 70


def test_the_first_half_second_follows_the_minimum():
    """It does so after each sample."""
    assert [error(fed([900, 700, 800, 300, 500][:n]), n) for n in range(1, 6)] == [
        900, 700, 700, 300, 300]


@pytest.mark.parametrize('fall', [5, 1, 0.3])
def test_a_backlog_at_the_start_is_followed_to_its_end(fall):
    """Each sample is a little earlier than the one before, for a second."""
    delays = [fall * 1000 * (SECOND - index) for index in range(SECOND)]
    tracker = fed([*delays, 0])
    assert error(tracker, SECOND) <= 1000
    fed([0] * 20, 0.0, tracker, SECOND + 1)
    assert abs(error(tracker, SECOND + 20)) < 20


def test_skew_is_estimated():
    """The error is below 0.5 ppm after a minute without noise."""
    assert fed([0] * 60 * SECOND, skew=30e-6).skew == pytest.approx(30e-6, abs=0.5e-6)


def test_the_estimate_follows_the_envelope_and_not_the_mean():
    """The mean delay is 4 ms."""
    tracker = fed(noise(60 * SECOND), skew=-40e-6)
    assert abs(error(tracker, 60 * SECOND, -40e-6)) < 150


def test_an_early_sample_needs_a_second_one():
    """The estimate ignores a single early sample."""
    tracker = fed([0] * 20 * SECOND)
    fed([0] * 50 + [-600_000] + [0] * 3 * SECOND, tracker=tracker, start=20 * SECOND)
    assert abs(error(tracker, 24 * SECOND)) < 20
    assert tracker.rejected == 1


def test_the_estimate_follows_two_early_samples_at_once():
    """All earlier samples were late."""
    tracker = fed([5000] * 20 * SECOND)
    fed([0] * 2, tracker=tracker, start=20 * SECOND)
    assert abs(error(tracker, 20 * SECOND + 2)) < 100
    fed([0] * 2 * SECOND, tracker=tracker, start=20 * SECOND)
    assert abs(error(tracker, 22 * SECOND)) < 20


def test_overload_is_ignored():
    """For 40 s, reads are late by 5 to 200 ms."""
    tracker = fed([0] * 20 * SECOND, skew=20e-6)
    source = random.Random(2)
    late = [source.uniform(5000, 200_000) for _ in range(40 * SECOND)]
    fed(late, 20e-6, tracker, 20 * SECOND)
    assert abs(error(tracker, 60 * SECOND, 20e-6)) < 50


def test_a_longer_path_is_accepted_after_ten_buckets():
    """All of them are late by the same amount."""
    tracker = fed([0] * 20 * SECOND)
    fed([3000] * 4 * SECOND, tracker=tracker, start=20 * SECOND)
    assert abs(error(tracker, 24 * SECOND)) < 50
    fed([3000] * 3 * SECOND, tracker=tracker, start=24 * SECOND)
    assert error(tracker, 27 * SECOND) == pytest.approx(3000, abs=50)


def test_delays_that_last_a_minute_are_accepted():
    """No earlier sample is recent enough."""
    tracker = fed([0] * 20 * SECOND)
    source = random.Random(3)
    fed([50_000 + source.uniform(0, 9000) for _ in range(62 * SECOND)], 0.0, tracker,
        20 * SECOND)
    assert error(tracker, 82 * SECOND) > 40_000


def test_restart_keeps_the_skew():
    """The skew depends on the crystal, which stays the same."""
    tracker = fed([0] * 30 * SECOND, skew=50e-6)
    tracker.restart()
    assert not tracker.started
    tracker.feed(0, OFFSET)
    assert tracker.host_time(10 ** 9) - OFFSET - 10 ** 9 == pytest.approx(50_000, abs=1000)


def test_two_measurements_computed_by_hand():
    """Two equally good measurements give their mean."""
    kalman = OffsetFilter(0, 1000, 10.0, 0.0, 0.0)
    kalman.correct(100, 100.0)
    assert kalman.offset(0) == 1050
    assert kalman.variance == pytest.approx(50)


def test_the_filter_keeps_nanoseconds_after_three_hundred_years():
    """Offsets are stored as an integer plus a small float."""
    kalman = OffsetFilter(10 ** 19, 3 * 10 ** 19 + 1, 10.0)
    assert kalman.offset(10 ** 19) == 3 * 10 ** 19 + 1


STEADY, WARMING = process_model(0.03, 0.002), process_model(0.5, 0.05)


def filter_errors(*models):
    """
    Return the median errors of a filter: in ppm with a steady clock, then in us while warming.

    It measures the offset every half second, with a deviation of 25 us.
    """
    source, kalman = random.Random(5), OffsetFilter(0, 0, 200_000.0, models=models)
    truth, skew, skew_errors, offset_errors = 0.0, 0.0, [], []
    step = 500_000_000
    for index in range(1, 1601):
        time = index * step
        if index > 1200:
            skew += 0.05e-6
        truth += skew * step
        kalman.predict(time)
        kalman.correct(truth + source.gauss(0.0, 25_000) - kalman.offset(time), 25_000.0 ** 2)
        if 200 < index <= 1200:
            skew_errors.append(abs(kalman.skew - skew) * 1e6)
        elif index > 1400:
            offset_errors.append(abs(kalman.offset(time) - truth) / 1000)
    return median(skew_errors), median(offset_errors)


def test_two_models_are_as_good_as_the_better_one():
    """A steady clock needs a long memory, a clock that warms up a short one."""
    steady, warming, both = (
        filter_errors(*models) for models in ((STEADY,), (WARMING,), (STEADY, WARMING)))
    assert steady[0] < warming[0] / 3 and warming[1] < steady[1] / 3
    assert both[0] < 2 * steady[0] and both[1] < 1.2 * warming[1]


def test_a_wide_gap_does_not_widen_the_gate():
    """Samples of a host that is late all the time are rejected, however far apart they are."""
    source = random.Random(4)
    tracker = fed([source.expovariate(1 / 20) for _ in range(60 * SECOND)])
    spread = tracker.spread
    fed([2000 + source.expovariate(1 / 90_000) for _ in range(40 * SECOND)], 0.0, tracker,
        60 * SECOND)
    assert abs(error(tracker, 100 * SECOND)) < 30
    assert tracker.spread < 2 * spread + 1000
