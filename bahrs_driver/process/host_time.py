# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read two clocks of the host at the same time.

Between two calls the process may be interrupted for milliseconds. So the system time is read
between two readings of the other clock. The time between these limits the error of the offset; if
it is long, all clocks are read again.
"""

import time
from typing import NamedTuple

from bahrs_driver.clock import Instant

NARROW = 20_000         # ns between two readings; more means an interruption
ATTEMPTS = 8


class PairedReading(NamedTuple):
    """A reading of a clock, and the bounds of system time minus this clock, in ns."""

    time: int
    least_offset: int
    most_offset: int

    @property
    def offset(self) -> int:
        """Return the estimated difference between system time and this clock."""
        return (self.least_offset + self.most_offset) // 2


def paired_reading(clock: int) -> PairedReading:
    """Read a clock (time.CLOCK_...) and the offset of system time from it."""
    first = before = time.clock_gettime_ns(clock)
    best: PairedReading | None = None
    for _ in range(ATTEMPTS):
        system = time.time_ns()
        after = time.clock_gettime_ns(clock)
        if best is None or after - before < best.most_offset - best.least_offset:
            best = PairedReading(first, system - after, system - before)
        if after - before < NARROW:
            break
        before = after
    assert best
    return best


def host_instant() -> Instant:
    """Read CLOCK_MONOTONIC_RAW and ROS time; the raw time is that of the call."""
    raw, least, most = paired_reading(time.CLOCK_MONOTONIC_RAW)
    return Instant(raw, raw + (least + most) // 2)


class SystemTime:
    """System time at monotonic times; it jumps only if the system time is set."""

    def __init__(self) -> None:
        self._offset: int | None = None

    def at(self, monotonic: int) -> int:
        """
        Return the system time at a monotonic time, in ns.

        Both clocks are slewed alike, so their offset is constant until the system time is set.
        The known offset is used while the bounds of the present readings contain it.
        """
        _, least, most = reading = paired_reading(time.CLOCK_MONOTONIC)
        if self._offset is None or not least <= self._offset <= most:
            self._offset = reading.offset
        return monotonic + self._offset
