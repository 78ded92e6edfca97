# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Covariance matrices as ROS messages carry them: flat, row by row.

REP-145 has two marks: all zeros when nothing is known of the covariance, and -1 in the first
element when the quantity itself is not reported. Consumers read the numbers: robot_localization
takes a variance of 0 for near certainty (1e-9), and leaves out what is NaN. So a standard
deviation of 0, which stands for unknown in the parameters, gives zeros only where the whole matrix
is unknown. A component that is not known beside others that are has UNKNOWN_VARIANCE, which no
filter takes for information.
"""

from collections.abc import Sequence

UNKNOWN_VARIANCE = 1e6          # in the square of the unit of its quantity

Matrix = tuple[float, ...]

UNKNOWN: Matrix = (0.0,) * 9
NOT_REPORTED: Matrix = (-1.0,) + (0.0,) * 8


def diagonal(variances: Sequence[float]) -> Matrix:
    """Return the flat square matrix with these variances on its diagonal."""
    size = len(variances)
    return tuple(variances[i] if i == j else 0.0 for i in range(size) for j in range(size))


def known_diagonal(variances: Sequence[float]) -> Matrix:
    """Return the flat diagonal matrix of variances of which those that are 0 are unknown."""
    if not any(variances):
        return diagonal(variances)
    return diagonal([variance or UNKNOWN_VARIANCE for variance in variances])


def of_vector(worth: Sequence[float | None], stddev: float) -> Matrix:
    """
    Return the covariance of a vector whose components have the same standard deviation.

    Each variance is multiplied by the worth of its component. One without worth (None) is not
    reported; if none has any the vector is not. A standard deviation of 0 is unknown.
    """
    if all(factor is None for factor in worth):
        return NOT_REPORTED
    return known_diagonal([UNKNOWN_VARIANCE if factor is None or not stddev and factor != 1.0
                           else factor * stddev ** 2 for factor in worth])


def of_orientation(deviations: Sequence[float | None]) -> Matrix:
    """
    Return the covariance of an orientation from its deviations about the three axes (rad).

    None and 0 are unknown.
    """
    return known_diagonal([(deviation or 0.0) ** 2 for deviation in deviations])


def of_z_only(index: int, stddev: float) -> Matrix:
    """Return the 6x6 covariance of a pose or twist of which only one component is measured."""
    variances = [UNKNOWN_VARIANCE] * 6
    variances[index] = stddev ** 2
    return known_diagonal(variances)


def of_pairs(first: Sequence[float], second: Sequence[float]) -> Matrix:
    """Return the 6x6 covariance of a pose or twist from the variances of its two halves."""
    return known_diagonal([*first, *second])
