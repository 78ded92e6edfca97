# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
GPS time of week to a time that a ROS message can carry.

A device that tells its time of week does not tell the week. Who knows it gets UTC; without it,
the time of week stays what it is.
"""

GPS_EPOCH_S = 315_964_800       # UNIX time of 6 January 1980
WEEK_US = 604_800 * 1_000_000
LATEST_US = 2 ** 31 * 1_000_000     # what a ROS time can hold


class GpsTime:
    """Puts times of week one after the other."""

    def __init__(self, week: int, leap_seconds: int) -> None:
        """Take the week since 1980 in which it begins, 0 if unknown, and GPS time less UTC."""
        self._week = week
        self._start_us = (GPS_EPOCH_S - leap_seconds) * 1_000_000
        self._last_us = 0

    def microseconds(self, time_of_week_s: float) -> int | None:
        """Return UTC since 1970, or time of week if the week is unknown; None if it is none."""
        time_us = round(time_of_week_s * 1000) * 1000
        if not self._week:
            return time_us
        if time_us >= WEEK_US:
            return None
        if time_us < self._last_us - WEEK_US // 2:
            self._week += 1
        self._last_us = time_us
        utc_us = self._start_us + self._week * WEEK_US + time_us
        return utc_us if utc_us < LATEST_US else None
