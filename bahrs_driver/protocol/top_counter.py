# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Counting of names from the wire, of which there may be millions, in bounded memory.

The 32 most frequent names are shown, and the sum of all others as 'other'. Up to 1,024 names are
tracked, and ranked exactly. When another name arrives, the less frequent half is dropped. A name
that arrives later is ranked as if it had been as frequent as the most frequent dropped one
(Metwally's Space-Saving, 2005), so that a name that becomes frequent late rises to its rank. Its
count includes only frames that arrived.
"""

from collections.abc import ItemsView, Iterator, Mapping
from heapq import nlargest

SHOWN = 32
TRACKED = 1024
OTHER = 'other'


class TopCounter(Mapping[str, int]):
    """
    A mapping from the most frequent names, and OTHER, to their counts.

    One thread may read it while another one counts.
    """

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._head_start: dict[str, int] = {}       # rank minus count
        self._floor = 0                             # highest rank that was dropped
        self._total = 0

    def add(self, name: str, count: int = 1) -> None:
        """Count a name."""
        if name not in self._counts:
            if len(self._counts) >= TRACKED:
                self._drop_half()
            self._head_start[name] = self._floor
        self._counts[name] = self._counts.get(name, 0) + count
        self._total += count

    def total(self) -> int:
        """Return the sum of all counts, OTHER included."""
        return self._total

    def items(self) -> ItemsView[str, int]:
        """Return names and counts, the most frequent first and OTHER last."""
        return self._shown().items()

    def __getitem__(self, name: str) -> int:
        return self._shown()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._shown())

    def __len__(self) -> int:
        return len(self._shown())

    def __repr__(self) -> str:
        return f'TopCounter({self._shown()})'

    def _shown(self) -> dict[str, int]:
        total, shown = self._total, dict(self._most_frequent(SHOWN))
        other = total - sum(shown.values())
        return {**shown, OTHER: other} if other > 0 else shown

    def _most_frequent(self, count: int) -> list[tuple[str, int]]:
        head_start = self._head_start
        # A copy, because the counting thread does not wait.
        return nlargest(count, list(self._counts.items()),
                        key=lambda item: item[1] + head_start.get(item[0], 0))

    def _drop_half(self) -> None:
        ranked = self._most_frequent(TRACKED)
        kept, dropped = ranked[:TRACKED // 2], ranked[TRACKED // 2:]
        name, count = dropped[0]
        self._floor = count + self._head_start[name]
        self._head_start = {name: self._head_start[name] for name, _ in kept}
        self._counts = dict(kept)
