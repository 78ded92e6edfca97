# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the two clocks of the host, with literal pairs in ns."""

from bahrs_driver.clock import Instant
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.units import NS_PER_S

ROS = 1_700_000_000 * NS_PER_S
MS = 1_000_000


def test_constant_offset():
    """The offset also holds before the first read and after the last."""
    host = HostClocks()
    assert host.observe_read(Instant(0, ROS)) == 0
    assert host.observe_read(Instant(16 * MS, ROS + 16 * MS)) == 0
    assert [host.to_ros_time(raw) for raw in (-5, 3 * MS, 20 * MS)] == [
        ROS - 5, ROS + 3 * MS, ROS + 20 * MS]


def test_conversion_is_linear_between_two_reads_of_a_slewed_clock():
    """A slew of 500 ppm is 8 us in 16 ms, and half of that in the middle."""
    host = HostClocks()
    host.observe_read(Instant(0, ROS))
    assert host.observe_read(Instant(16 * MS, ROS + 16 * MS + 8000)) == 0
    assert host.to_ros_time(8 * MS) == ROS + 8 * MS + 4000
    assert host.steps == 0


def test_the_fastest_slew_is_no_step():
    """Chrony slews at 8.3 % at most."""
    host = HostClocks()
    host.observe_read(Instant(0, ROS))
    assert host.observe_read(Instant(100 * MS, ROS + 108 * MS)) == 0


def test_a_step_applies_at_once_and_is_returned():
    """It also applies to samples that were measured before it and read after it."""
    host = HostClocks()
    host.observe_read(Instant(0, ROS))
    assert host.observe_read(Instant(16 * MS, ROS + 516 * MS)) == 500 * MS
    assert host.to_ros_time(10 * MS) == ROS + 510 * MS
    assert host.observe_read(Instant(32 * MS, ROS + 432 * MS)) == -100 * MS
    assert host.steps == 2 and host.last_step_ns == -100 * MS
