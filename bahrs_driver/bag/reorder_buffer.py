# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Sort a stream whose items arrive almost in the order of their log times."""

from collections.abc import Iterator
import heapq
import math
from typing import Generic, TypeVar

T = TypeVar('T')


class ReorderBuffer(Generic[T]):
    """Holds items until no earlier one is expected, and at most a number of them."""

    def __init__(self, max_items: float = math.inf) -> None:
        self.count = 0                  # items added so far
        self._max_items = max_items
        self._heap: list[tuple[int, int, T]] = []
        self._last_ns = 0               # log time of the latest item that was removed

    def add(self, log_ns: int, item: T) -> None:
        """Hold an item. Those of equal log times keep their order."""
        heapq.heappush(self._heap, (log_ns, self.count, item))
        self.count += 1

    def pop_until(self, log_ns: float = math.inf) -> Iterator[tuple[int, T]]:
        """
        Remove and yield the items up to a log time, each with its own.

        An item that was added too late gets the log time of the one before it.
        """
        heap = self._heap
        while heap and (heap[0][0] <= log_ns or len(heap) > self._max_items):
            item_ns, _, item = heapq.heappop(heap)
            self._last_ns = max(item_ns, self._last_ns)
            yield self._last_ns, item
