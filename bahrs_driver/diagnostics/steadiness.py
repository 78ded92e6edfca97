# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Whether counters grow as fast as they should.

What host or adapter hold back in one span of time comes in the next, so one span proves nothing:
a rate is wrong if it was too low in two spans on end, or too high in both. And as spans are looked
at when they end, a rate at the edge of its tolerance does not change its verdict at every message.
"""

from collections.abc import Callable, Sequence
import threading

LEAST = 2.0         # counts by which a span may always be off


class Steadiness:
    """Watches counters. One thread may ask while another begins anew."""

    def __init__(self, read: Callable[[], Sequence[int]], rates: Sequence[float],
                 tolerance: float, span: float) -> None:
        """
        Expect the counters that read returns to grow by rates in Hz; 0 is any.

        A span in seconds may be off by the tolerance, a share of what is expected.
        """
        self._read = read
        self._rates = rates
        self._tolerance = tolerance
        self._span = span
        self._lock = threading.Lock()
        self._start: tuple[float, Sequence[int]] | None = None
        self._sides = [0] * len(rates)
        self._wrong: dict[int, float] = {}

    def restart(self) -> None:
        """Forget what was, and begin when asked next."""
        with self._lock:
            self._start = None
            self._sides = [0] * len(self._rates)
            self._wrong = {}

    def wrong(self, now: float) -> dict[int, float]:
        """Return the measured rate of each counter whose rate is wrong, by its index."""
        with self._lock:
            if self._start is None:
                self._start = now, self._read()
            elif now - self._start[0] >= self._span:
                self._look(now, *self._start)
            return self._wrong

    def _look(self, now: float, begin: float, before: Sequence[int]) -> None:
        counts, elapsed = self._read(), now - begin
        growth = [new - old for new, old in zip(counts, before)]
        sides = [self._side(grown, elapsed * rate) for grown, rate in zip(growth, self._rates)]
        self._wrong = {index: growth[index] / elapsed
                       for index, (side, last) in enumerate(zip(sides, self._sides))
                       if side and side == last}
        self._start, self._sides = (now, counts), sides

    def _side(self, count: int, expected: float) -> int:
        """Return -1 for too few, 1 for too many, 0 for right."""
        if not expected or abs(count - expected) <= max(LEAST, expected * self._tolerance):
            return 0
        return 1 if count > expected else -1
