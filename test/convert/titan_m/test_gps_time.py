# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of GPS time of week to UTC, by the host's clock or the parameter gps.week."""

from datetime import datetime, timezone

from bahrs_driver.convert.titan_m.gps_time import EARLIEST_HOST_NS, GPS_EPOCH_S, GpsTime, WEEK_US
from bahrs_driver.convert.values import TimeReference
from bahrs_driver.ros_layout.message_objects import to_message
from hypothesis import given, strategies as st

NO_CLOCK = 5 * 10 ** 9          # ns, of a host that has been running for 5 s
WEEK = WEEK_US // 10 ** 6       # s
LEAP = 18


def utc(microseconds):
    """Return a date."""
    return datetime.fromtimestamp(microseconds / 1e6, timezone.utc)


def nanoseconds(week, time_of_week_s):
    """Return the time of a correct host clock at a GPS time."""
    return (GPS_EPOCH_S - LEAP + week * WEEK) * 10 ** 9 + round(time_of_week_s * 10 ** 9)


TIMES = st.integers(0, WEEK * 1000 - 1).map(lambda milliseconds: milliseconds / 1000)


@given(week=st.integers(2087, 3000), time=TIMES, given_week=st.integers(0, 3000),
       wrong_s=st.integers(-WEEK // 2 + 1, WEEK // 2 - 1))
def test_the_week_is_the_nearest_to_the_clock_of_the_host(week, time, given_week, wrong_s):
    """The host's clock may be wrong by half a week, and gps.week may have any value."""
    gps, host_ns = GpsTime(given_week, LEAP), nanoseconds(week, time + wrong_s)
    if host_ns >= EARLIEST_HOST_NS:
        assert gps.utc_us(time, host_ns) == round(nanoseconds(week, time) / 10 ** 6) * 1000
        assert bool(gps.problem) == (given_week not in (0, week))


def test_a_stale_week_is_reported_once():
    """The diagnostics report it as long as it lasts."""
    gps = GpsTime(2400, LEAP)
    for time in (5.0, 6.0):
        assert utc(gps.utc_us(time, nanoseconds(2401, time))) == datetime(
            2026, 1, 10, 23, 59, 42 + int(time), tzinfo=timezone.utc)
    (sentence,) = gps.take_notices()
    assert sentence == gps.problem == (
        'It is week 2400 by gps.week and week 2401 by the clock of the host, which is used: '
        'correct gps.week, or leave it 0')
    assert gps.take_notices() == []


def test_a_week_that_ends_is_not_stale():
    """gps.week was right at the start."""
    gps = GpsTime(2400, LEAP)
    last = gps.utc_us(604_799.9, nanoseconds(2400, 604_799.9))
    assert gps.utc_us(604_799.8, nanoseconds(2400, 604_799.8)) == last - 100_000
    assert gps.utc_us(0.1, nanoseconds(2401, 0.1)) == last + 200_000
    assert gps.problem == '' and gps.take_notices() == []


def test_a_host_without_a_clock_needs_the_week():
    """The next week begins when the time of week restarts, not when a message is a little old."""
    gps = GpsTime(2400, LEAP)
    assert utc(gps.utc_us(0.0, NO_CLOCK)) == datetime(
        2026, 1, 3, 23, 59, 42, tzinfo=timezone.utc)
    last = gps.utc_us(604_799.9, NO_CLOCK)
    assert gps.utc_us(604_799.8, NO_CLOCK) == last - 100_000
    assert gps.utc_us(0.1, NO_CLOCK) == last + 200_000
    assert gps.problem == ''


def test_without_week_and_clock_there_is_no_time():
    """The time is known as soon as the clock is set."""
    gps = GpsTime(0, LEAP)
    assert gps.utc_us(376_038.084, NO_CLOCK) is None
    assert 'time_reference is not published: set the clock of the host, or gps.week' \
        in gps.problem
    assert len(gps.take_notices()) == 1
    assert gps.utc_us(5.0, nanoseconds(2400, 5.0)) == nanoseconds(2400, 5.0) // 1000
    assert gps.problem == '' and gps.take_notices() == []


def test_impossible_times():
    """They are beyond the week, or beyond the range of a ROS time."""
    assert GpsTime(2400, LEAP).utc_us(700_000.0, NO_CLOCK) is None
    assert GpsTime(3028, LEAP).utc_us(604_000.0, NO_CLOCK) is None
    latest = GpsTime(3000, LEAP).utc_us(604_799.0, NO_CLOCK)
    values = TimeReference(0, '', latest * 1000, 'gps')
    assert to_message(values).time_ref.sec < 2 ** 31
