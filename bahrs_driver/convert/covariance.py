# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Build covariance matrices for ROS messages: flat, row by row.

REP-145 has two marks: all zeros if the covariance is unknown, and -1 in the first element if the
quantity itself is not reported. Subscribers use the numbers: robot_localization treats a variance
of 0 as near certainty (1e-9), and ignores NaN. So a standard deviation of 0, which means unknown
in the parameters, gives zeros only if the whole matrix is unknown. An unknown component beside
known ones has UNKNOWN_VARIANCE, which no filter uses as information.
"""

from functools import lru_cache

from bahrs_driver.protocol.layout import Vector

UNKNOWN_VARIANCE = 1e6          # in the square of the unit of its quantity

Matrix = tuple[float, ...]
_REMEMBERED = 256               # matrices; few differ, because deviations are settings

UNKNOWN: Matrix = (0.0,) * 9
NOT_REPORTED: Matrix = (-1.0,) + (0.0,) * 8


@lru_cache(maxsize=_REMEMBERED)
def diagonal(variances: tuple[float, ...]) -> Matrix:
    """Return the flat square matrix with these variances on its diagonal."""
    size = len(variances)
    return tuple(variances[i] if i == j else 0.0 for i in range(size) for j in range(size))


@lru_cache(maxsize=_REMEMBERED)
def known_diagonal(variances: tuple[float, ...]) -> Matrix:
    """Return the flat diagonal matrix of variances, of which 0 is unknown."""
    if not any(variances):
        return diagonal(variances)
    return diagonal(tuple([variance or UNKNOWN_VARIANCE for variance in variances]))


@lru_cache(maxsize=_REMEMBERED)
def of_vector(factors: tuple[float | None, ...], stddev: float) -> Matrix:
    """
    Return the covariance of a vector whose components have the same standard deviation.

    Each variance is multiplied by the factor of its component. A component with factor None is not
    reported; if all factors are None, the vector is not. A standard deviation of 0 is unknown.
    """
    if all(factor is None for factor in factors):
        return NOT_REPORTED
    return known_diagonal(tuple(
        UNKNOWN_VARIANCE if factor is None or not stddev and factor != 1.0
        else factor * stddev ** 2 for factor in factors))


def of_orientation(deviations: tuple[float | None, ...]) -> Matrix:
    """
    Return the covariance of an orientation from standard deviations about the three axes (rad).

    None and 0 are unknown.
    """
    return known_diagonal(tuple((deviation or 0.0) ** 2 for deviation in deviations))


@lru_cache(maxsize=_REMEMBERED)
def of_z_only(index: int, stddev: float) -> Matrix:
    """Return the 6x6 covariance of a pose or twist of which only one component is measured."""
    variances = [UNKNOWN_VARIANCE] * 6
    variances[index] = stddev ** 2
    return known_diagonal(tuple(variances))


def of_pairs(first: Vector, second: Vector) -> Matrix:
    """Return the 6x6 covariance of a pose or twist from the variances of its two halves."""
    return known_diagonal(first + second)
