# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Sort a stream whose items arrive almost in the order of their log times."""

from bisect import bisect_right
from collections.abc import Iterable
import math
from operator import itemgetter
from typing import Generic, TypeVar

T = TypeVar('T')

_log_time = itemgetter(0)


class ReorderBuffer(Generic[T]):
    """Holds items until no earlier one is expected, and at most a number of them."""

    def __init__(self, max_items: int | None = None) -> None:
        self._max_items = max_items
        self._items: list[tuple[int, T]] = []
        self._last_ns = 0               # log time of the latest item that was removed

    def __len__(self) -> int:
        """Return the number of items held."""
        return len(self._items)

    def add(self, items: Iterable[tuple[int, T]]) -> None:
        """Hold items with their log times. Those of equal log times keep their order."""
        self._items += items

    def pop_until(self, log_ns: float = math.inf) -> list[tuple[int, T]]:
        """
        Remove and return the items up to a log time, each with its own.

        An item that was added too late gets the log time of the one before it. All items that are
        held are sorted: where they are many, remove many at a time.
        """
        items = self._items
        items.sort(key=_log_time)       # a single pass over what is in order already
        count = bisect_right(items, log_ns, key=_log_time)
        if self._max_items is not None:
            count = max(count, len(items) - self._max_items)
        found, self._items = items[:count], items[count:]
        late = bisect_right(found, self._last_ns, key=_log_time)
        found[:late] = [(self._last_ns, item) for _, item in found[:late]]
        if found:
            self._last_ns, _ = found[-1]
        return found
