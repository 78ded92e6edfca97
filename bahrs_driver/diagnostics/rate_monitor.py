# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure whether counters grow at their rates.

Messages that a host or adapter holds back in one span of time arrive in the next, so one span
proves nothing: a rate is wrong if it is too low, or too high, in two consecutive spans. It is
measured only at the end of a span, or else a rate near its tolerance would change its state with
every message.
"""

from collections.abc import Callable, Sequence
import threading

MIN_TOLERANCE = 2.0         # counts by which any span may differ


class RateMonitor:
    """
    Watches the counters that read returns; each should grow at its rate in Hz, 0 for any rate.

    Each rate is measured over a span in seconds, and may differ from the expected rate by the
    tolerance, a fraction of it. One thread may call wrong() while another calls restart().
    """

    def __init__(self, read: Callable[[], Sequence[int]], rates: Sequence[float],
                 tolerance: float, span: float) -> None:
        self._read = read
        self._rates = rates
        self._tolerance = tolerance
        self._span = span
        self._lock = threading.Lock()
        self._start: tuple[float, Sequence[int]] | None = None
        self._sides = [0] * len(rates)      # of the expected rates in the last span
        self._wrong: dict[int, float] = {}

    def restart(self) -> None:
        """Forget all spans; the next call of wrong() begins a new one."""
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
        """Return -1 if a count is too low, 1 if it is too high, otherwise 0."""
        if not expected or abs(count - expected) <= max(MIN_TOLERANCE, expected * self._tolerance):
            return 0
        return 1 if count > expected else -1
