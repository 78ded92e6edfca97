# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A schedule of periodic turns. Times are in ns of any one clock."""

from collections.abc import Mapping
from typing import Generic, TypeVar

from bahrs_driver.units import NS_PER_S

CATCH_UP = 5            # overdue turns that are still taken; earlier ones are skipped

Kind = TypeVar('Kind')


class Schedule(Generic[Kind]):
    """Schedules each kind on a fixed grid: a late turn does not shift the next one."""

    def __init__(self, rates: Mapping[Kind, float]) -> None:
        """Schedule each kind at a rate in Hz; 0 is never. Ties go to the kind given first."""
        self._periods = {kind: round(NS_PER_S / rate) for kind, rate in rates.items() if rate}
        self._due: dict[Kind, int] = {}
        self.skipped = 0            # turns that were too late to be taken

    def start(self, now: int) -> None:
        """Make every kind due now."""
        self._due = dict.fromkeys(self._periods, now)

    def due(self, now: int) -> list[Kind]:
        """Return the kinds that are due, longest overdue first."""
        return sorted((kind for kind, time in self._due.items() if time <= now),
                      key=lambda kind: self._due[kind])

    def next_after(self, now: int) -> int | None:
        """Return the time of the first turn after now; None if there is none."""
        return min((time for time in self._due.values() if time > now), default=None)

    def advance(self, kind: Kind, now: int) -> None:
        """Schedule the next turn of a kind after it took one."""
        period = self._periods[kind]
        due = self._due[kind] + period
        missed = max(0, (now - due) // period + 1 - CATCH_UP)
        self.skipped += missed
        self._due[kind] = due + missed * period
