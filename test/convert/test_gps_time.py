# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of GPS time."""

from datetime import datetime, timezone

from bahrs_driver.convert.gps_time import GpsTime
from bahrs_driver.convert.ros import time_reference
from std_msgs.msg import Header


def utc(microseconds):
    """Return a date."""
    return datetime.fromtimestamp(microseconds / 1e6, timezone.utc)


def test_without_a_week_it_is_the_time_of_week():
    """To the millisecond."""
    assert GpsTime(0, 18).microseconds(376_038.084) == 376_038_084_000


def test_with_a_week_it_is_utc():
    """Week 2400 began on 4 January 2026, when UTC was 18 leap seconds behind."""
    assert utc(GpsTime(2400, 18).microseconds(0.0)) == datetime(
        2026, 1, 3, 23, 59, 42, tzinfo=timezone.utc)


def test_the_week_goes_on():
    """When the time of week begins again, and not when a message is a little old."""
    time = GpsTime(2400, 18)
    last = time.microseconds(604_799.9)
    assert time.microseconds(604_799.8) == last - 100_000
    assert time.microseconds(0.1) == last + 200_000


def test_what_is_no_time():
    """Beyond the week, and beyond what a message holds."""
    assert GpsTime(2400, 18).microseconds(700_000.0) is None
    assert GpsTime(3028, 18).microseconds(604_000.0) is None
    latest = GpsTime(3000, 18).microseconds(604_799.0)
    assert time_reference(Header(), latest, 'gps').time_ref.sec < 2 ** 31
