# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert GPS time of week to UTC.

The device does not report the week. It follows from the host's clock, unless that was never set:
the week is the one whose time is nearest to the host's. A week set by the user serves a host
without a clock, and is otherwise only compared. Without either, the time is unknown.
"""

from bahrs_driver.clock.notices import Notices
from bahrs_driver.units import NS_PER_S, NS_PER_US, ROS_TIME_END_S, US_PER_S

GPS_EPOCH_S = 315_964_800       # UNIX time of 6 January 1980
WEEK_US = 604_800 * US_PER_S
LATEST_US = ROS_TIME_END_S * US_PER_S
# A host whose clock shows an earlier time started without one: 1 January 2020.
EARLIEST_HOST_NS = 1_577_836_800 * NS_PER_S


class GpsTime:
    """Converts successive times of week; leap_seconds is GPS time minus UTC."""

    def __init__(self, week: int, leap_seconds: int) -> None:
        self._week = week               # since 1980; 0 if unknown
        self._start_us = (GPS_EPOCH_S - leap_seconds) * US_PER_S
        self._last_us = 0
        self._notices = Notices()
        self.problem = ''               # a sentence about a wrong or unknown week

    def utc_us(self, time_of_week_s: float, host_ns: int) -> int | None:
        """Return UTC in microseconds since 1970, near the host's time; None if unknown."""
        time_us = round(time_of_week_s * 1000) * 1000
        if not 0 <= time_us < WEEK_US:
            return None
        if self._week and time_us < self._last_us - WEEK_US // 2:
            self._week += 1
        self._last_us = time_us
        week = self._week_near(host_ns, time_us)
        utc_us = self._start_us + week * WEEK_US + time_us
        return utc_us if week and utc_us < LATEST_US else None

    def take_notices(self) -> list[str]:
        """Return sentences for the log since the last call."""
        return self._notices.take()

    def _week_near(self, host_ns: int, time_us: int) -> int:
        """Return the week of a time of week, 0 if unknown; update the problem."""
        week, problem = self._week, ''
        if host_ns >= EARLIEST_HOST_NS:
            since_us = host_ns // NS_PER_US - self._start_us - time_us
            week = (since_us + WEEK_US // 2) // WEEK_US
        elif not week:
            problem = ('The GPS week is unknown, and time_reference is not published: set the '
                       'clock of the host, or gps.week')
        if self._week and week != self._week:
            problem = (f'It is week {self._week} by gps.week and week {week} by the clock of the '
                       'host, which is used: correct gps.week, or leave it 0')
        if problem and not self.problem:
            self._notices.add(problem)
        self.problem = problem
        return week
