# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a device, which runs a little faster or slower than true time."""

import math
import random

from bahrs_driver.units import US_PER_S


class DeviceClock:
    """
    Counts microseconds from power-on.

    Its rate differs from true time by a constant drift and by a random walk, both in ppm.
    """

    def __init__(self, seed: int, drift_ppm: float = 0.0, wander_ppm: float = 0.0,
                 start_us: int = 0) -> None:
        """Set drift, random walk in ppm per square root of a second, and the first reading."""
        self.drift_ppm = drift_ppm
        self._wander_ppm = wander_ppm
        self._start_us = start_us
        self._gauss = random.Random(f'clock {seed}').gauss
        self._walk_ppm = 0.0
        self.restart(0.0)

    def restart(self, time: float) -> None:
        """Restart at a true time in seconds, as after power-on."""
        self.time = time
        self.reading_us = self._start_us

    def advance(self, duration_us: int) -> None:
        """Advance the reading, and true time with it."""
        self.reading_us += duration_us
        seconds = duration_us / US_PER_S
        self.time += seconds / self._rate
        if self._wander_ppm:
            self._walk_ppm += self._gauss(0.0, self._wander_ppm * math.sqrt(seconds))

    def reading_at(self, time: float) -> int:
        """Return the reading at a true time close to the present."""
        return self.reading_us + round((time - self.time) * self._rate * US_PER_S)

    @property
    def _rate(self) -> float:
        return 1 + (self.drift_ppm + self._walk_ppm) / 1e6
