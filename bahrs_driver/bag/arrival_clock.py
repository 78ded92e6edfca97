# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Determine the log times of messages as they arrive.

The middleware gives the arrival of a message in ROS time. If the host's clock was set before the
message is taken, that is a time of the clock as it was before. So the latest offsets of ROS time
are kept, each with the period in which it was valid.
"""

from collections import deque
from collections.abc import Callable
import threading
from typing import NamedTuple

from bahrs_driver.bag.log_clock import LATEST, LogClock
from bahrs_driver.clock import Instant
from bahrs_driver.process.host_time import host_instant
from bahrs_driver.units import NS_PER_S

MAX_OFFSETS = 10                    # kept
MAX_AGE = 60 * NS_PER_S             # for which a message may have waited


class OffsetPeriod(NamedTuple):
    """
    An offset of ROS time, and the log times between which it may have been valid.

    The host's clock is set between two readings, so the periods of two offsets overlap.
    """

    offset: int         # ns that ROS time is ahead of log time
    begin: int
    end: int

    def log_time(self, ros_ns: int) -> int | None:
        """Convert a ROS time to log time; None outside the period."""
        log_ns = ros_ns - self.offset
        return log_ns if self.begin <= log_ns <= self.end else None


class ArrivalLogClock:
    """Log times while recording, for any thread. read returns the host's two clocks."""

    def __init__(self, read: Callable[[], Instant] = host_instant) -> None:
        self._read = read
        self._lock = threading.Lock()
        self._clock = LogClock()
        self._periods = deque([OffsetPeriod(0, 0, LATEST)], MAX_OFFSETS)
        self._last = 0
        self.start = self.now()

    def now(self) -> int:
        """Return the present log time."""
        with self._lock:
            instant = self._read()
            now = self._clock.observe(instant.ros_ns, instant.raw_ns)
            if now.offset != self._periods[-1].offset:
                self._periods[-1] = self._periods[-1]._replace(end=now.log_ns)
                self._periods.append(OffsetPeriod(now.offset, self._last, LATEST))
            self._last = now.log_ns
            return now.log_ns

    def log_time(self, now: int, *ros_times: int | None) -> int:
        """Return the log time of the first ROS time that is shortly before now; else now."""
        with self._lock:
            periods = list(self._periods)
        for ros_ns in filter(None, ros_times):
            log_times = [log_ns for period in periods
                         if (log_ns := period.log_time(ros_ns)) is not None
                         and now - MAX_AGE < log_ns <= now]
            if log_times:
                return max(log_times)
        return now

    def sentences(self) -> list[str]:
        """Return a sentence for each time that the host's clock was set."""
        return self._clock.sentences()
