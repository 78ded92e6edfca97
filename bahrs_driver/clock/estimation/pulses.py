# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Synchronisation pulses: what samples alone cannot tell, the delay that even the fastest have.

The device tells the device time of a pulse. Its ROS time is known from elsewhere: a pulse from a
GNSS receiver comes at every whole second, and a host that is disciplined by the same receiver
need only look which second is nearest; or whoever made the pulse tells. Such pairs are good to
a microsecond or two, and a filter of offset and skew goes through them. How far the passive
tracker is from it is that delay, by which the tracker is corrected when pulses stop.
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
MISSES = 4                      # in a row, until it starts again
DELAYS = 31                     # pulses whose delay is remembered
PENDING = 8


class PulseTracker:
    """Estimates host time for device time from pulses."""

    def __init__(self, period: int) -> None:
        """Take the period of the pulses, in ns."""
        self.accepted = self.spurious = self.missing = 0
        self._period = period
        self._filter: OffsetFilter | None = None
        self._in_row = self._misfits = 0

    def restart(self) -> None:
        """Forget all but the counts."""
        self._filter = None
        self._in_row = self._misfits = 0

    @property
    def settled(self) -> bool:
        """Whether enough pulses have come to go by."""
        return self._in_row >= SETTLED_AFTER

    @property
    def skew(self) -> float:
        """By how much host time runs faster than device time."""
        return self._filter.skew if self._filter else 0.0

    def host_time(self, device: int) -> int:
        """Return the host's time when the device's was this. There must have been a pulse."""
        assert self._filter
        return device + self._filter.offset(device)

    def feed(self, device: int, host: int, skew: float, skew_deviation: float) -> bool:
        """Take both times of a pulse; return whether it is believed. The skew helps at first."""
        line = self._filter
        if line is None:
            self._start(device, host, skew, skew_deviation)
            return True
        periods = round((device - line.time) / self._period)
        if periods < 1:
            self.spurious += 1
            return False
        innovation = host - self.host_time(device)
        line_variance = line.variance + (line.skew_deviation * (device - line.time)) ** 2
        gate = GATE_DEVIATIONS * math.sqrt(line_variance + DEVIATION ** 2) + GATE_MARGIN
        if abs(innovation) > gate:
            return self._misfit(device, host, skew, skew_deviation)
        self.missing += periods - 1 - self._misfits if periods - 1 > self._misfits else 0
        line.predict(device)
        line.correct(innovation, DEVIATION ** 2)
        self.accepted += 1
        self._in_row += 1
        self._misfits = 0
        return True

    def lost(self, device: int) -> bool:
        """Whether too many pulses are missing by this device time; it has then restarted."""
        line = self._filter
        if line is None or device - line.time <= (MISSES + 0.5) * self._period:
            return False
        was_settled = self.settled
        self.missing += max(0, MISSES - self._misfits)
        self.restart()
        return was_settled

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
    """Finds the ROS time of a pulse: told by somebody, or the nearest whole period."""

    def __init__(self, period: int, told: bool) -> None:
        """Take the period of the pulses in ns, and whether somebody tells their times."""
        self._period = period
        self._told: deque[int] | None = deque(maxlen=PENDING) if told else None

    def tell(self, ros: int) -> None:
        """Take the ROS time of a pulse. May be called from any thread."""
        if self._told is not None:
            self._told.append(ros)

    def find(self, about: int) -> int | None:
        """Return the ROS time of the pulse that came about then; None if none is known."""
        if self._told is None:
            return (about + self._period // 2) // self._period * self._period
        near = min(self._told.copy(), key=lambda ros: abs(ros - about), default=None)
        return near if near is not None and abs(near - about) < self._period // 2 else None


class DelayEstimate:
    """The median of what pulses say that the fastest samples are late by."""

    def __init__(self) -> None:
        self._delays: deque[int] = deque(maxlen=DELAYS)
        self.value: int | None = None

    def add(self, delay: int) -> None:
        """Take what one pulse says."""
        self._delays.append(delay)
        self.value = round(median(self._delays))
