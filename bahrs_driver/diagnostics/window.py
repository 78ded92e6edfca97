# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Measure how counters changed over the last second or two."""

from collections import deque
from collections.abc import Callable, Sequence
import threading

Counts = tuple[int, ...]


class Window:
    """
    Measures how much the counters that read returns grew in the last one to two spans.

    A span is given in seconds. In its first span, a window covers the time since its first call.
    One thread may call growth() while another calls restart().
    """

    def __init__(self, read: Callable[[], Sequence[int]], span: float = 1.0) -> None:
        self._read = read
        self._span = span
        self._marks: deque[tuple[float, Counts]] = deque()
        self._lock = threading.Lock()

    def restart(self) -> None:
        """Forget the counters."""
        with self._lock:
            self._marks.clear()

    def growth(self, now: float) -> tuple[float, Counts]:
        """Return the seconds covered, and the growth of each counter in this time."""
        with self._lock:
            return self._growth(now, tuple(self._read()))

    def _growth(self, now: float, counts: Counts) -> tuple[float, Counts]:
        if not self._marks or now - self._marks[-1][0] >= self._span:
            self._marks.append((now, counts))
        while len(self._marks) > 1 and now - self._marks[1][0] >= self._span:
            self._marks.popleft()
        begin, before = self._marks[0]
        return now - begin, tuple(new - old for new, old in zip(counts, before))
