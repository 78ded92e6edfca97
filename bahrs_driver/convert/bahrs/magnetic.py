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


def north_east_down(roll: float, pitch: float, heading: float) -> tuple[Vector, Vector, Vector]:
    """Return the directions north, east and down in forward, right, down (angles in radians)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    ch, sh = math.cos(heading), math.sin(heading)
    return ((cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh),
            (cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch),
            (-sp, sr * cp, cr * cp))


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
    north, east, down = north_east_down(roll, pitch, heading)
    horizontal, vertical = strength * math.cos(dip), strength * math.sin(dip)
    (nx, ny, nz), (dx, dy, dz) = north, down
    field = convention.body((horizontal * nx + vertical * dx, horizontal * ny + vertical * dy,
                             horizontal * nz + vertical * dz))
    if heading_std is None:
        return field, covariance.UNKNOWN
    across = math.hypot(horizontal * heading_std,
                        vertical * (1.0 if north_std is None else north_std))
    return field, _open_but_along(convention.body(east), strength, across)


def _open_but_along(direction: Vector, stddev: float, stddev_along: float) -> Matrix:
    """Return a covariance that is the same in all directions but one."""
    variance = stddev ** 2
    x, y, z = direction
    difference = stddev_along ** 2 - variance
    xy, xz, yz = difference * x * y, difference * x * z, difference * y * z
    return (variance + difference * x * x, xy, xz,
            xy, variance + difference * y * y, yz,
            xz, yz, variance + difference * z * z)
