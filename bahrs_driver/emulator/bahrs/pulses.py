# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Pulses on the synchronisation input of a device."""

import math

LEAST_DISTANCE = 0.09       # s; a device ignores a pulse that comes sooner after one it took


class Pulses:
    """A pulse at every whole multiple of a period, of a time whose zero may be elsewhere."""

    def __init__(self, rate: float, origin: float = 0.0) -> None:
        """Take the rate in Hz, 0 for no pulses, and any time in seconds that has a pulse."""
        self.rate = rate
        self._origin = origin
        self._seen_until = -math.inf
        self._taken = -math.inf

    def skip_until(self, time: float) -> None:
        """Let the pulses up to this time pass unseen."""
        self._seen_until = time

    def latest(self, time: float) -> float | None:
        """Return the time of the last pulse up to now, unless it was seen or came too soon."""
        seen_until, self._seen_until = self._seen_until, time
        if not self.rate:
            return None
        pulse = self._origin + math.floor((time - self._origin) * self.rate) / self.rate
        if pulse <= seen_until or pulse - self._taken < LEAST_DISTANCE:
            return None
        self._taken = pulse
        return pulse
