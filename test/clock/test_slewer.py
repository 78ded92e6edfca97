# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of stamps by estimates, with literal numbers in ns."""

from bahrs_driver.clock import Instant
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.slewer import StampSlewer
import pytest

MS = 1_000_000
ROS = 10 ** 18
PERIOD = 5 * MS
FAR = 10 ** 12


def slewer(latency=0):
    """Return a slewer whose host has ROS time = raw + ROS."""
    host = HostClocks()
    host.observe_read(Instant(0, ROS))
    return StampSlewer(host, latency)


def stamps(made, targets, start=0, bound=FAR):
    """Return the stamps, minus ROS, of samples a period apart with these estimates in ns."""
    now = Instant(FAR, ROS + FAR)
    return [made.stamp(index * PERIOD, target, 0.0, bound, now) - ROS
            for index, target in enumerate(targets, start)]


def test_a_steady_estimate_is_the_stamp():
    """The fixed latency is subtracted."""
    targets = [100 * MS + index * PERIOD for index in range(3)]
    assert stamps(slewer(), targets) == targets
    assert stamps(slewer(latency=250), targets) == [target - 250 for target in targets]


def test_a_correction_is_spread_over_time():
    """Later the rate is 500 ppm, which is 2.5 us per 5 ms."""
    made = slewer()
    stamps(made, [index * PERIOD for index in range(700)])
    moved = stamps(made, [700 * PERIOD + 6000, 701 * PERIOD + 6000, 702 * PERIOD + 6000], 700)
    assert moved == [700 * PERIOD + 2500, 701 * PERIOD + 5000, 702 * PERIOD + 6000]


def test_corrections_are_fast_at_the_start():
    """The rate is 10 %, which is half a millisecond per 5 ms."""
    assert stamps(slewer(), [0, PERIOD - 600_000]) == [0, PERIOD - 500_000]


def test_stamps_increase_strictly():
    """The estimate may jump back."""
    made = slewer()
    assert [made.stamp_arrival(raw) - ROS for raw in (1000, 1000, 900, 5000)] == [
        1000, 1001, 1002, 5000]


def test_no_stamp_is_later_than_its_bound():
    """The bound also limits stamps that slew."""
    made = slewer()
    stamps(made, [index * PERIOD for index in range(700)])
    assert stamps(made, [700 * PERIOD - MS], 700, bound=700 * PERIOD - MS + 10) == [
        700 * PERIOD - MS + 10]


def test_a_bound_ends_the_slew():
    """Stamps continue from the bound: they do not follow later arrivals up again."""
    made = slewer()
    stamps(made, [index * PERIOD for index in range(700)])
    low = [index * PERIOD - 4 * MS for index in range(700, 703)]
    stamps(made, low[:1], 700)
    assert stamps(made, low[1:2], 701, bound=low[1] + 10) == [low[1] + 10]
    assert stamps(made, low[2:], 702) == [low[2]]


def test_a_time_after_its_own_read_is_impossible():
    """The limit is a millisecond."""
    made = slewer()
    now = Instant(50 * MS, ROS + 50 * MS)
    assert made.stamp(0, 52 * MS, 0.0, 49 * MS, now) is None
    assert made.stamp(PERIOD, 50 * MS + 500_000, 0.0, 49 * MS, now) == ROS + 49 * MS


def test_stamps_go_back_only_if_the_host_clock_was_set_back():
    """All nodes of that host use the new time."""
    host = HostClocks()
    made = StampSlewer(host, 0)
    host.observe_read(Instant(0, ROS))
    first = made.stamp_arrival(0)
    host.observe_read(Instant(PERIOD, ROS - 10 ** 9))
    made.allow_backward()
    assert first == ROS and made.stamp_arrival(PERIOD) == ROS - 10 ** 9


@pytest.mark.parametrize('skew', [-100e-6, 100e-6])
def test_skew_needs_no_correction(skew):
    """Stamps follow the skew of the estimate without slewing."""
    made, now = slewer(), Instant(FAR, ROS + FAR)
    for index in range(1000):
        device = index * PERIOD
        target = device + round(skew * device)
        stamp = made.stamp(device, target, skew, FAR, now)
    assert stamp - ROS == pytest.approx(target, abs=2)
