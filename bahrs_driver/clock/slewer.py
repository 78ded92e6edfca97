# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
From estimates to stamps that people can use: smooth, in order, and never from the future.

An estimate may move when more is known. Stamps follow it slowly, so that the time between two
samples stays what it was; fast only at the start. A stamp is never later than what the bytes
prove, and never as early as the one before. What is about a time between samples, such as a
pulse, goes on the same line and is in order with its own kind.
"""

from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.interface import Instant
from bahrs_driver.units import NS_PER_MS, NS_PER_S

SLEW, FIRST_SLEW = 500e-6, 0.1
FIRST_SPAN = 3 * NS_PER_S
IMPOSSIBLE = NS_PER_MS              # after its own read


class Output:
    """Makes stamps."""

    def __init__(self, host: HostClocks, fixed_latency: int) -> None:
        """Take the host's clocks, and what to subtract from all stamps, in ns."""
        self._host = host
        self._fixed_latency = fixed_latency
        self._last_ros = 0
        self._last_of: dict[type, int] = {}     # stamp of the latest message of each type
        self.restart()

    def restart(self) -> None:
        """Another epoch begins: stamps may jump."""
        self._lag = 0.0                     # of the stamps behind the estimate
        self._device = self._target = 0
        self._begin: int | None = None

    def hurry(self) -> None:
        """Let stamps follow fast for a while, as at the start."""
        self._begin = self._device

    def allow_backward(self) -> None:
        """Let the next stamp be earlier than the last: the host was set back."""
        self._last_ros = 0
        self._last_of.clear()

    def stamp(self, device: int, target: int, skew: float, bound: int, now: Instant) -> int | None:
        """
        Return the stamp of the next sample, or None if its time cannot be.

        device is its device time, target the host's raw time estimated for it, bound the raw time
        that it was not sent after, now the read that brought it.
        """
        if target > now.raw_ns + IMPOSSIBLE:
            return None
        return self.arrival(min(target + self._follow(device, target, skew), bound))

    def arrival(self, raw: int) -> int:
        """Return the stamp of a sample of which only a raw time is known."""
        self._last_ros = max(self.plain(raw), self._last_ros + 1)
        return self._last_ros

    def between(self, target: int, bound: int) -> int:
        """Return the stamp of an estimated raw time, on the line that samples are on."""
        return self.plain(min(target + round(self._lag), bound))

    def in_order(self, kind: type, stamp: int) -> int:
        """Return a stamp, moved behind that of the latest message of its kind if need be."""
        self._last_of[kind] = max(stamp, self._last_of.get(kind, 0) + 1)
        return self._last_of[kind]

    def plain(self, raw: int) -> int:
        """Return the ROS time of a raw time, whatever came before."""
        return self._host.ros(raw) - self._fixed_latency

    def _follow(self, device: int, target: int, skew: float) -> int:
        """Return what to add to the estimate so that stamps do not jump with it."""
        if self._begin is None:
            self._begin = device
            self._device, self._target = device, target
            return 0
        step = device - self._device
        lag = self._lag + self._target - target + step + skew * step
        rate = FIRST_SLEW if device - self._begin < FIRST_SPAN else SLEW
        limit = rate * abs(step)
        self._lag = lag - limit if lag > limit else lag + limit if lag < -limit else 0.0
        self._device, self._target = device, target
        return round(self._lag)
