# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which inertial sample belongs to a navigation message.

The device measures inertially twice as often as it navigates, and sends the navigation solution
right after the inertial sample that it was made with. Either may be lost on the way, so nearness
is not enough: both counters are looked at. `inertial - 2 * navigation` (modulo 256) is the same
for every true pair for as long as the device runs.
"""

from collections import deque
from typing import Generic, TypeVar

from bahrs_driver.units import COUNTER_MODULUS


INERTIAL_PER_NAVIGATION = 2
WITNESSES = 5           # pairs in a row that must agree before a new difference is believed

Sample = TypeVar('Sample')


class Pairing(Generic[Sample]):
    """Remembers the latest inertial sample, and tells which navigation message goes with it."""

    def __init__(self) -> None:
        self._latest: tuple[int, Sample] | None = None
        self._difference: int | None = None
        self._recent: deque[int] = deque(maxlen=WITNESSES)

    def inertial(self, sequence: int, sample: Sample) -> None:
        """Take the next inertial sample."""
        self._latest = sequence, sample

    def navigation(self, sequence: int) -> Sample | None:
        """Return the inertial sample of the navigation message with this counter, if it came."""
        if self._latest is None:
            return None
        inertial, sample = self._latest
        difference = (inertial - INERTIAL_PER_NAVIGATION * sequence) % COUNTER_MODULUS
        self._recent.append(difference)
        if self._difference is None or self._recent.count(difference) == WITNESSES:
            self._difference = difference
        return sample if difference == self._difference else None
