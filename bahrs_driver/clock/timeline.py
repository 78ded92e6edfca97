# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time of samples between time messages.

The latest time message is the anchor; the period is the slope over the time messages of the last
five seconds, if it is within 3 % of the nominal period.
"""

from collections import deque

from bahrs_driver.units import NS_PER_US

HISTORY = 51                    # time messages, ten per second
PERIOD_TOLERANCE = 0.03
JITTER = 200 * NS_PER_US        # of a time message


class Timeline:
    """Device time in ns by count."""

    def __init__(self, count: int, time: int, period: int) -> None:
        """Begin with the device time of one sample, and a nominal period in ns."""
        self._nominal = period
        self._history: deque[tuple[int, int]] = deque([(count, time)], maxlen=HISTORY)
        self._count, self._time = count, time
        self._elapsed, self._samples = period, 1
        self._tolerance = PERIOD_TOLERANCE * period

    @property
    def period(self) -> float:
        """Nanoseconds from one sample to the next."""
        return self._elapsed / self._samples

    @property
    def latest(self) -> tuple[int, int]:
        """Count and device time of the latest time message."""
        return self._count, self._time

    def time_of(self, count: int) -> int:
        """Return the device time of a sample."""
        return self._time + (count - self._count) * self._elapsed // self._samples

    def count_at(self, time: int) -> int:
        """Return the count of the sample nearest to a device time."""
        return self._count + round((time - self._time) * self._samples / self._elapsed)

    def agrees(self, count: int, time: int) -> bool:
        """Whether a time message fits the timeline."""
        allowed = JITTER + self._tolerance * abs(count - self._count)
        return abs(time - self.time_of(count)) <= allowed

    def accept(self, count: int, time: int) -> None:
        """Add a time message that fits."""
        if count <= self._count:
            return
        self._history.append((count, time))
        self._count, self._time = count, time
        first, start = self._history[0]
        samples, elapsed = count - first, time - start
        nominal = samples * self._nominal
        if abs(elapsed - nominal) <= PERIOD_TOLERANCE * nominal:
            self._elapsed, self._samples = elapsed, samples
            self._tolerance = JITTER / samples

    def move(self, count: int, time: int) -> None:
        """Replace all time messages by one, and keep the period: the count was lost."""
        self._history.clear()
        self._history.append((count, time))
        self._count, self._time = count, time
