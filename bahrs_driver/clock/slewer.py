# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
From estimated times to stamps: smooth, increasing, and never in the future.

An estimate may jump when more samples are known. Stamps follow it at a limited rate, which keeps
the time between two samples right; the rate is higher at the start. A stamp is never later than
the upper bound of its frame, and always later than the one before. A message about a time between
samples, such as a pulse, uses the same slew, and is in order with messages of its own type.
"""

from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.interface import Instant
from bahrs_driver.units import NS_PER_MS, NS_PER_S

SLEW, FIRST_SLEW = 500e-6, 0.1      # ns per ns
FIRST_SPAN = 3 * NS_PER_S
IMPOSSIBLE = NS_PER_MS              # after the read that brought the sample


class StampSlewer:
    """Makes stamps."""

    def __init__(self, host: HostClocks, fixed_latency: int) -> None:
        """Subtract fixed_latency ns from each stamp."""
        self._host = host
        self._fixed_latency = fixed_latency
        self._last_ros = 0
        self._last_of: dict[type, int] = {}     # stamp of the latest message of each type
        self.restart()

    def restart(self) -> None:
        """Begin another epoch, in which stamps may jump."""
        self._lead = 0.0                    # of the stamps over the estimate, ns
        self._device = self._target = 0
        self._begin: int | None = None

    def allow_fast_slew(self) -> None:
        """Slew at the fast rate for a while, as at the start."""
        self._begin = self._device

    def allow_backward(self) -> None:
        """Allow the next stamp to precede the last: the host's clock was set back."""
        self._last_ros = 0
        self._last_of.clear()

    def stamp(self, device: int, target: int, skew: float, bound: int, now: Instant) -> int | None:
        """
        Return the stamp of the next sample, or None if its time is impossible.

        device is its device time, target the raw time estimated for it, bound the latest raw time
        at which it was sent, now the read that brought it.
        """
        if target > now.raw_ns + IMPOSSIBLE:
            return None
        stamp = self.stamp_arrival(min(target + self._follow(device, target, skew), bound))
        self._lead = min(self._lead, max(0.0, bound - target))      # slew on from the bound
        return stamp

    def stamp_arrival(self, raw: int) -> int:
        """Return the stamp of a sample of which only a raw time is known."""
        self._last_ros = max(self.to_ros_time(raw), self._last_ros + 1)
        return self._last_ros

    def stamp_between(self, target: int, bound: int) -> int:
        """Return the stamp of an estimated raw time between samples."""
        return self.to_ros_time(min(target + round(self._lead), bound))

    def in_order(self, kind: type, stamp: int) -> int:
        """Return a stamp, but later than that of the latest message of its type."""
        self._last_of[kind] = max(stamp, self._last_of.get(kind, 0) + 1)
        return self._last_of[kind]

    def to_ros_time(self, raw: int) -> int:
        """Convert a raw time to ROS time, minus the fixed latency."""
        return self._host.to_ros_time(raw) - self._fixed_latency

    def _follow(self, device: int, target: int, skew: float) -> int:
        """Slew toward the estimate; return the remaining lead over it."""
        if self._begin is None:
            self._begin = device
            self._device, self._target = device, target
            return 0
        step = device - self._device
        lead = self._lead + self._target - target + step + skew * step
        rate = FIRST_SLEW if device - self._begin < FIRST_SPAN else SLEW
        limit = rate * abs(step)
        self._lead = lead - max(-limit, min(limit, lead))
        self._device, self._target = device, target
        return round(self._lead)
