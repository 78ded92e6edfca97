# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Sync pulses: they measure the delay of the fastest samples, which samples alone cannot.

The device reports the device time of a pulse. Its ROS time comes from elsewhere: a GNSS receiver
sends a pulse at every whole second, and a host disciplined by the same receiver only has to round
to the nearest second; or the source of the pulse reports its time. Such pairs are accurate to a
microsecond or two, and a filter of offset and skew tracks them. The difference of the passive
estimate to it is the delay, which corrects the passive estimate when pulses stop.
"""

from collections import deque
import math
from statistics import median

from bahrs_driver.clock.estimation.kalman import OffsetFilter
from bahrs_driver.units import NS_PER_US

DEVIATION = 2 * NS_PER_US
GATE_DEVIATIONS, GATE_MARGIN = 5, 20 * NS_PER_US
FIRST_DEVIATION = 5 * NS_PER_US
SETTLED_AFTER = 3               # pulses
MISSES = 4                      # in a row, before the tracker restarts
DELAYS = 31                     # pulses in the median of the delay
PENDING = 8


class PulseTracker:
    """Estimates host time for device time from pulses."""

    def __init__(self, period: int) -> None:
        """Start without a pulse; period is in ns."""
        self.accepted = self.spurious = self.missing = 0
        self._period = period
        self._filter: OffsetFilter | None = None
        self._in_row = self._misfits = 0

    def restart(self) -> None:
        """Discard all but the counts."""
        self._filter = None
        self._in_row = self._misfits = 0

    @property
    def settled(self) -> bool:
        """Whether enough pulses support the estimate."""
        return self._in_row >= SETTLED_AFTER

    @property
    def skew(self) -> float:
        """How much faster host time runs than device time, in ns per ns."""
        return self._filter.skew if self._filter else 0.0

    def host_time(self, device: int) -> int:
        """Return the host time of a device time. There must have been a pulse."""
        assert self._filter
        return device + self._filter.offset(device)

    def feed(self, device: int, host: int, skew: float, skew_deviation: float) -> bool:
        """Add both times of a pulse; return whether it fits. The first one uses the skew."""
        kalman = self._filter
        if kalman is None:
            self._start(device, host, skew, skew_deviation)
            return True
        periods = round((device - kalman.time) / self._period)
        if periods < 1:
            self.spurious += 1
            return False
        innovation = host - self.host_time(device)
        variance = kalman.variance + (kalman.skew_deviation * (device - kalman.time)) ** 2
        gate = GATE_DEVIATIONS * math.sqrt(variance + DEVIATION ** 2) + GATE_MARGIN
        if abs(innovation) > gate:
            return self._misfit(device, host, skew, skew_deviation)
        self.missing += max(0, periods - 1 - self._misfits)
        kalman.predict(device)
        kalman.correct(innovation, DEVIATION ** 2)
        self.accepted += 1
        self._in_row += 1
        self._misfits = 0
        return True

    def check_timeout(self, device: int) -> None:
        """Restart if too many pulses are missing by this device time."""
        kalman = self._filter
        if kalman and device - kalman.time > (MISSES + 0.5) * self._period:
            self.missing += max(0, MISSES - self._misfits)
            self.restart()

    def _start(self, device: int, host: int, skew: float, skew_deviation: float) -> None:
        self._filter = OffsetFilter(device, host - device, FIRST_DEVIATION, skew, skew_deviation)
        self._in_row = 1
        self._misfits = 0
        self.accepted += 1

    def _misfit(self, device: int, host: int, skew: float, skew_deviation: float) -> bool:
        self.spurious += 1
        self._misfits += 1
        if self._misfits < MISSES:
            return False
        self._start(device, host, skew, skew_deviation)
        return True


class PulseReference:
    """Finds the ROS time of a pulse: an external time, or the nearest whole period."""

    def __init__(self, period: int, external: bool) -> None:
        """Use whole periods, in ns, unless ROS times come from an external source."""
        self._period = period
        self._external: deque[int] | None = deque(maxlen=PENDING) if external else None

    def add(self, ros: int) -> None:
        """Add the ROS time of an external pulse. Any thread may call it."""
        if self._external is not None:
            self._external.append(ros)

    def find(self, estimated: int) -> int | None:
        """Return the ROS time of a pulse by its estimated time; None if none is near."""
        if self._external is None:
            return (estimated + self._period // 2) // self._period * self._period
        nearest = min(self._external.copy(), key=lambda ros: abs(ros - estimated), default=None)
        return nearest if nearest is not None and \
            abs(nearest - estimated) < self._period // 2 else None


class DelayEstimate:
    """The median delay of the fastest samples, as measured by pulses."""

    def __init__(self) -> None:
        self._delays: deque[int] = deque(maxlen=DELAYS)
        self.value: int | None = None

    def add(self, delay: int) -> None:
        """Add the delay by one pulse."""
        self._delays.append(delay)
        self.value = round(median(self._delays))
