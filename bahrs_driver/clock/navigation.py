# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The sample that a navigation message was computed from.

With two samples per navigation message, `sample - 2 * navigation` of the sequence counters (modulo
256) is constant for as long as the device runs: 0, as both counters start at 0. Each navigation
message and the sample before it show it, but the true sample may be lost. At first the most
frequent of the latest five differences is used, and 0 starts with two votes. After five equal ones
in a row, only another five in a row change it.
"""

from collections import deque

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.units import COUNTER_MODULUS

WITNESSES = 5
PRIOR = 2                       # votes for 0 at the start
NEARBY = 4                      # navigation messages that may be lost before it is certain


class NavigationCounter:
    """
    Finds the sample of a navigation message, with a number of samples per navigation message.

    prior is the number of votes for the difference 0 at the start.
    """

    def __init__(self, samples: int, prior: int = PRIOR) -> None:
        self._samples = samples
        self._difference, self._certain = 0, False
        self._recent: deque[int] = deque([0] * prior, maxlen=WITNESSES)

    def pair(self, navigation: int, sample: int) -> None:
        """Add the counters of a navigation message and of the latest sample."""
        difference = (sample - self._samples * navigation) % COUNTER_MODULUS
        self._recent.append(difference)
        if self._certain and difference == self._difference:
            return                      # no other difference can be unanimous
        frequent = max(self._recent, key=self._recent.count)
        unanimous = self._recent.count(frequent) == WITNESSES
        if unanimous or not self._certain:
            self._difference = frequent
            self._certain = unanimous

    def matches(self, navigation: int, sample: int) -> bool:
        """Return whether a navigation message was computed from a sample, by their counters."""
        return (sample - self._samples * navigation) % COUNTER_MODULUS == self._difference

    def count(self, navigation: int, near: CountedSequence) -> int | None:
        """
        Return the count of the sample of a navigation message, None if it is not known.

        near is the latest sample before that message.
        """
        found = near.nearest(self._samples * navigation + self._difference)
        return found if self._certain or \
            abs(found - near.count) <= NEARBY * self._samples else None
