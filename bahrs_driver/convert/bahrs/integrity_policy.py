# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What a signal is worth by its integrity, as a factor on its variance.

A safe signal has its variance as it is, an unavailable one has no worth at all (None), and for one
at integrity risk the user decides: it is published with a larger variance, withheld, or passed on.
"""

from collections.abc import Iterable
import math
from typing import Literal

from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from bahrs_driver.protocol.integrity import Health, Integrity
from bahrs_driver.protocol.layout import Vector

UNKNOWN_DEVIATION = math.sqrt(UNKNOWN_VARIANCE)
RiskPolicy = Literal['inflate', 'withhold', 'pass']
Worth = float | None


class Appraisal:
    """Tells what signals are worth."""

    def __init__(self, policy: RiskPolicy, inflation: float) -> None:
        at_risk: dict[str, Worth] = {'inflate': inflation, 'withhold': None, 'pass': 1.0}
        self._worth: dict[Integrity, Worth] = {
            Integrity.SAFE: 1.0, Integrity.INTEGRITY_RISK: at_risk[policy],
            Integrity.UNAVAILABLE: None, Integrity.RESERVED: None}

    def of(self, health: Health) -> list[Worth]:
        """Return the worth of each signal."""
        return [self._worth[integrity] for integrity in health]


def reported(vector: Vector, worth: Iterable[Worth]) -> Vector:
    """Return the vector with NaN in place of components without worth."""
    x, y, z = (math.nan if value is None else component
               for component, value in zip(vector, worth))
    return x, y, z


def inflated(deviation: float | None, worth: float) -> float | None:
    """
    Return a standard deviation whose variance is multiplied by the worth.

    None, which is not known, stays so for a safe signal and is unknown in so many words for one
    at risk.
    """
    if deviation is None:
        return None if worth == 1.0 else UNKNOWN_DEVIATION
    return deviation * math.sqrt(worth)
