# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure whether counters grow at their rates.

What a host or adapter holds back in one span of time comes in the next, so one span proves
nothing: a rate is wrong if it was too low in two spans in a row, or too high in both. Rates are
measured at the end of a span only, so a rate at the edge of its tolerance does not change its
state at every message.
"""

from collections.abc import Callable, Sequence
import threading

MIN_TOLERANCE = 2.0         # counts by which a span may always differ


class RateMonitor:
    """
    Watches counters that read returns, and that should grow by rates in Hz; 0 is any rate.

    A span in seconds may differ by the tolerance, a share of the expected count. One thread may
    call wrong() while another calls restart().
    """

    def __init__(self, read: Callable[[], Sequence[int]], rates: Sequence[float],
                 tolerance: float, span: float) -> None:
        self._read = read
        self._rates = rates
        self._tolerance = tolerance
        self._span = span
        self._lock = threading.Lock()
        self._start: tuple[float, Sequence[int]] | None = None
        self._sides = [0] * len(rates)
        self._wrong: dict[int, float] = {}

    def restart(self) -> None:
        """Forget all spans; the next call of wrong() begins another."""
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
                self._measure(now, *self._start)
            return self._wrong

    def _measure(self, now: float, begin: float, before: Sequence[int]) -> None:
        counts, elapsed = self._read(), now - begin
        growth = [new - old for new, old in zip(counts, before)]
        sides = [self._side(grown, elapsed * rate) for grown, rate in zip(growth, self._rates)]
        self._wrong = {index: growth[index] / elapsed
                       for index, (side, last) in enumerate(zip(sides, self._sides))
                       if side and side == last}
        self._start, self._sides = (now, counts), sides

    def _side(self, count: int, expected: float) -> int:
        """Return -1 for too few, 1 for too many, 0 for right."""
        if not expected or abs(count - expected) <= max(MIN_TOLERANCE, expected * self._tolerance):
            return 0
        return 1 if count > expected else -1
