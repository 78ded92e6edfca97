# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""When something is due that is to happen at given rates. Times are in ns, of any clock."""

from collections.abc import Mapping
from typing import Generic, TypeVar

from bahrs_driver.units import NS_PER_S


CATCH_UP = 5            # periods that may be made up for; beyond, turns are skipped

Kind = TypeVar('Kind')


class Schedule(Generic[Kind]):
    """Tells what is due, each kind on a grid of its own, so that being late once costs nothing."""

    def __init__(self, rates: Mapping[Kind, float]) -> None:
        """Take a rate in Hz for each kind; 0 is never. Of two due at once the former is first."""
        self._periods = {kind: round(NS_PER_S / rate) for kind, rate in rates.items() if rate}
        self._due: dict[Kind, int] = {}
        self.skipped = 0            # turns that could not be made up for

    def begin(self, now: int) -> None:
        """Let everything be due."""
        self._due = dict.fromkeys(self._periods, now)

    def due(self, now: int) -> list[Kind]:
        """Return what is due by now, that first which has been so for longest."""
        return sorted((kind for kind, time in self._due.items() if time <= now),
                      key=lambda kind: self._due[kind])

    def next_after(self, now: int) -> int | None:
        """Return when the next turn comes that is not due by now; None if there is none."""
        return min((time for time in self._due.values() if time > now), default=None)

    def take(self, kind: Kind, now: int) -> None:
        """Take note that a kind has had its turn."""
        period = self._periods[kind]
        due = self._due[kind] + period
        missed = max(0, (now - due) // period + 1 - CATCH_UP)
        self.skipped += missed
        self._due[kind] = due + missed * period
