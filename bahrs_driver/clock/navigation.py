# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which inertial sample a navigation message is of the same time as.

`inertial - 2 * navigation` (modulo 256) is constant for as long as the device runs: 0, as both
counters begin at 0. Each pair of neighbours gives it, but one of a pair may be lost. At first the
most frequent value of the last few pairs counts, where 0 has two votes in advance; once five in
a row have agreed, only another five in a row change it.
"""

from collections import deque

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.units import COUNTER_MODULUS

PER_NAVIGATION = 2
WITNESSES = 5
PRIOR = 2               # pairs that 0 is worth at first
NEARBY = 4 * PER_NAVIGATION     # samples that may be lost before it is certain


class NavigationCounter:
    """Finds the inertial sample that goes with a navigation message."""

    def __init__(self) -> None:
        self._difference, self._certain = 0, False
        self._recent: deque[int] = deque([0] * PRIOR, maxlen=WITNESSES)

    def pair(self, navigation: int, inertial: int) -> None:
        """Take the counter of a navigation message and of the latest inertial one."""
        self._recent.append((inertial - PER_NAVIGATION * navigation) % COUNTER_MODULUS)
        frequent = max(self._recent, key=self._recent.count)
        unanimous = self._recent.count(frequent) == WITNESSES
        if unanimous or not self._certain:
            self._difference = frequent
            self._certain = unanimous

    def count(self, navigation: int, near: CountedSequence) -> int | None:
        """
        Return the count of the inertial sample of a navigation message, None if unknown.

        near is the inertial sample that came last before that message.
        """
        found = near.nearest(PER_NAVIGATION * navigation + self._difference)
        return found if self._certain or abs(found - near.count) <= NEARBY else None
