# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Pulses on the synchronisation input of a device."""

import math

MIN_DISTANCE = 0.09       # s; the device ignores a pulse that follows sooner


class Pulses:
    """Pulses at whole multiples of a period, relative to an origin."""

    def __init__(self, rate: float, origin: float = 0.0) -> None:
        """Set the rate in Hz, 0 for no pulses, and the time of any pulse in seconds."""
        self.rate = rate
        self._origin = origin
        self._seen_until = -math.inf
        self._accepted = -math.inf          # time of the latest accepted pulse

    def skip_until(self, time: float) -> None:
        """Ignore the pulses up to a time."""
        self._seen_until = time

    def take_latest(self, time: float) -> float | None:
        """Return the time of the latest pulse by this time; None if there is no new one."""
        seen_until, self._seen_until = self._seen_until, time
        if not self.rate:
            return None
        pulse = self._origin + math.floor((time - self._origin) * self.rate) / self.rate
        if pulse <= seen_until or pulse - self._accepted < MIN_DISTANCE:
            return None
        self._accepted = pulse
        return pulse
