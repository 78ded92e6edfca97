# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Ranges of samples."""

from collections import deque


class CountRanges:
    """Ranges of counts, which are added and looked up in ascending order."""

    def __init__(self) -> None:
        self._ranges: deque[tuple[int, int]] = deque()

    def add(self, after: int, last: int) -> None:
        """Add the counts after one up to another; a range that ends with the first continues."""
        if self._ranges and self._ranges[-1][1] == after <= last:
            after, _ = self._ranges.pop()
        self._ranges.append((after, last))

    def contains(self, count: int) -> bool:
        """Return whether a range contains a count; lower ranges are discarded."""
        while self._ranges and self._ranges[0][1] < count:
            self._ranges.popleft()
        return bool(self._ranges) and self._ranges[0][0] < count
