# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Determine the log times of messages as they arrive.

The middleware gives the arrival of a message in ROS time. If ROS time was set before the message
is taken, that is a time on the earlier clock: each setting applies to the times while it lasted.
"""

from collections import deque
from collections.abc import Callable
import threading
from typing import NamedTuple

from bahrs_driver.bag.log_clock import LATEST, LogClock
from bahrs_driver.clock import Instant
from bahrs_driver.process.host_time import host_instant
from bahrs_driver.units import NS_PER_S

KEPT = 10                           # settings of the clock at which a message may have arrived
MAX_AGE = 60 * NS_PER_S             # for which a message may have waited


class Setting(NamedTuple):
    """A setting of ROS time. The clock was set between two readings."""

    offset: int         # ns that ROS time is ahead of log time
    begin: int          # log time of the reading before it was set
    end: int            # log time of the reading after it was set again


class ArrivalLogClock:
    """Log times while recording, for any thread. read returns the host's two clocks."""

    def __init__(self, read: Callable[[], Instant] = host_instant) -> None:
        self._read = read
        self._lock = threading.Lock()
        self._clock = LogClock()
        self._settings = deque([Setting(0, 0, LATEST)], KEPT)
        self._last = 0
        self.began = self.now()

    def now(self) -> int:
        """Return the present log time."""
        with self._lock:
            instant = self._read()
            moment = self._clock.observe(instant.ros_ns, instant.raw_ns)
            if moment.offset != self._settings[-1].offset:
                self._settings[-1] = self._settings[-1]._replace(end=moment.log_ns)
                self._settings.append(Setting(moment.offset, self._last, LATEST))
            self._last = moment.log_ns
            return moment.log_ns

    def log_time(self, now: int, *ros_times: int | None) -> int:
        """Return the log time of the first ROS time that is shortly before now; else now."""
        with self._lock:
            settings = list(self._settings)
        for ros_ns in ros_times:
            found = max((log_ns for offset, begin, end in settings
                         if begin <= (log_ns := (ros_ns or 0) - offset) <= min(now, end)),
                        default=0)
            if found > now - MAX_AGE:
                return found
        return now

    def sentences(self) -> list[str]:
        """Return a sentence for each time that the host's clock was set."""
        return self._clock.sentences()
