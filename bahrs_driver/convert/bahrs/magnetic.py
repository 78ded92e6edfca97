# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Derive a magnetic field from the heading of a device that measures no field.

The horizontal part of the earth's field points to magnetic north, whose direction the heading
gives. Strength and dip are assumed, so only the direction across the field, in the horizontal
plane, is known; the covariance is open along the other two. In that direction an error of the
heading moves the horizontal part of the field, and a tilt about magnetic north the vertical part.
"""

import math

from bahrs_driver.convert import covariance
from bahrs_driver.convert.axes import Convention
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.protocol.layout import Vector
import numpy as np
from numpy.typing import NDArray


def rotation_to_body(roll: float, pitch: float, heading: float) -> NDArray[np.float64]:
    """Return the rotation matrix from north, east, down to forward, right, down (radians)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    ch, sh = math.cos(heading), math.sin(heading)
    return np.array([
        [cp * ch, cp * sh, -sp],
        [sr * sp * ch - cr * sh, sr * sp * sh + cr * ch, sr * cp],
        [cr * sp * ch + sr * sh, cr * sp * sh - sr * ch, cr * cp]])


def derived_field(roll: float, pitch: float, heading: float, heading_std: float | None,
                  strength: float, dip: float, convention: Convention,
                  north_std: float | None = 0.0) -> tuple[Vector, Matrix]:
    """
    Return the body field that fits attitude and magnetic heading, and its covariance.

    Angles are in radians, the dip positive downward, strength and result in tesla. north_std is
    the standard deviation of the attitude about magnetic north. In the unknown directions the
    standard deviation is the whole strength. Without a standard deviation of the heading the
    covariance is unknown.
    """
    to_body = rotation_to_body(roll, pitch, heading)
    horizontal, vertical = strength * math.cos(dip), strength * math.sin(dip)
    field = convention.body(_vector(to_body @ (horizontal, 0.0, vertical)))
    if heading_std is None:
        return field, covariance.UNKNOWN
    to_published = np.array([convention.body(_vector(column)) for column in to_body.T]).T
    across = math.hypot(horizontal * heading_std,
                        vertical * (1.0 if north_std is None else north_std))
    variances = np.diag([strength ** 2, across ** 2, strength ** 2])
    matrix = to_published @ variances @ to_published.T
    return field, tuple(float(element) for element in matrix.flat)


def _vector(array: NDArray[np.float64]) -> Vector:
    x, y, z = array
    return float(x), float(y), float(z)
