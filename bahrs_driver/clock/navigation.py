# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which inertial sample a navigation message is of the same time as.

`inertial - 2 * navigation` (modulo 256) is the same for as long as the device runs. It is taken
from the first pair of neighbours, and anew when five in a row say another, as one of a pair may
be lost.
"""

from collections import deque

from bahrs_driver.clock.counter import MODULUS

PER_NAVIGATION = 2
WITNESSES = 5


class NavigationCounter:
    """Tells the inertial counter that goes with that of a navigation message."""

    def __init__(self) -> None:
        """Start without a pair."""
        self._difference: int | None = None
        self._recent: deque[int] = deque(maxlen=WITNESSES)

    def pair(self, navigation: int, inertial: int) -> None:
        """Take the counter of a navigation message and of the latest inertial one."""
        difference = (inertial - PER_NAVIGATION * navigation) % MODULUS
        self._recent.append(difference)
        if self._difference is None or self._recent.count(difference) == WITNESSES:
            self._difference = difference

    def inertial(self, navigation: int) -> int | None:
        """Return the inertial counter for a navigation counter, if pairs were seen."""
        if self._difference is None:
            return None
        return (PER_NAVIGATION * navigation + self._difference) % MODULUS
