# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Map the integrity of a signal to a factor on its variance.

The factor of a safe signal is 1, and an unavailable signal has none (None). For a signal at
integrity risk the user decides: it is published with a larger variance, withheld, or passed on.
"""

from functools import lru_cache
import math
from typing import Literal

from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from bahrs_driver.protocol.integrity import Health, Integrity, REMEMBERED
from bahrs_driver.protocol.layout import Vector

UNKNOWN_STDDEV = math.sqrt(UNKNOWN_VARIANCE)
RiskPolicy = Literal['inflate', 'withhold', 'pass']
VarianceFactor = float | None


class IntegrityPolicy:
    """Returns variance factors; inflation is that of a signal at risk with policy 'inflate'."""

    def __init__(self, policy: RiskPolicy, inflation: float) -> None:
        at_risk: dict[str, VarianceFactor] = {'inflate': inflation, 'withhold': None, 'pass': 1.0}
        self._factors: dict[Integrity, VarianceFactor] = {
            Integrity.SAFE: 1.0, Integrity.INTEGRITY_RISK: at_risk[policy],
            Integrity.UNAVAILABLE: None, Integrity.RESERVED: None}
        self.variance_factors = lru_cache(maxsize=REMEMBERED)(self._variance_factors)

    def _variance_factors(self, health: Health) -> tuple[VarianceFactor, ...]:
        """Return the variance factor of each signal."""
        return tuple(self._factors[integrity] for integrity in health)


def mask_unavailable(vector: Vector, factors: tuple[VarianceFactor, ...]) -> Vector:
    """Return the vector with NaN in place of components without a variance factor."""
    if None not in factors:
        return vector
    x, y, z = (math.nan if factor is None else component
               for component, factor in zip(vector, factors))
    return x, y, z


def inflated_stddev(stddev: float | None, factor: float) -> float | None:
    """
    Return a standard deviation whose variance is multiplied by the factor.

    None stays None for a safe signal and becomes UNKNOWN_STDDEV for one at risk.
    """
    if stddev is None:
        return None if factor == 1.0 else UNKNOWN_STDDEV
    return stddev * math.sqrt(factor)
