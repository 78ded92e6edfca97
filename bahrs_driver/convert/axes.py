# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert from the axes of the devices to those of ROS.

The devices use forward, right, down (FRD) and north, east, down (NED). REP-103 requires forward,
left, up (FLU) and east, north, up (ENU). A Convention converts to the published axes; there is one
for each value of the parameter `frame_convention`.
"""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import Any, NamedTuple

from bahrs_driver.protocol.layout import Vector

_SQRT_HALF = math.sqrt(0.5)


class Quaternion(NamedTuple):
    """A rotation from body axes to navigation axes, scalar first."""

    w: float
    x: float
    y: float
    z: float


NO_ROTATION = Quaternion(1.0, 0.0, 0.0, 0.0)
_HALF_TURN_ABOUT_X = Quaternion(0.0, 1.0, 0.0, 0.0)


def quaternion_from_euler(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation by yaw about z, then pitch about y, then roll about x (radians)."""
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)
    return Quaternion(
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy)


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the rotation that applies the second rotation, then the first."""
    w, x, y, z = first
    a, b, c, d = second
    return Quaternion(w * a - x * b - y * c - z * d, w * b + x * a + y * d - z * c,
                      w * c - x * d + y * a + z * b, w * d + x * c - y * b + z * a)


def conjugate(rotation: Quaternion) -> Quaternion:
    """Return the opposite rotation."""
    w, x, y, z = rotation
    return Quaternion(w, -x, -y, -z)


def same_sign(rotation: Quaternion, last: Quaternion) -> Quaternion:
    """
    Return a rotation with the sign that is nearer to the last one.

    Both signs are the same attitude, but a change of the sign is a jump for programs that
    interpolate or filter the components.
    """
    w, x, y, z = rotation
    if w * last.w + x * last.x + y * last.y + z * last.z >= 0.0:
        return rotation
    return Quaternion(-w, -x, -y, -z)


def rotate_to_body(vector: Vector, body_to_world: Quaternion) -> Vector:
    """Rotate a vector from navigation axes to body axes."""
    w, x, y, z = body_to_world
    a, b, c = vector
    # Twice the cross product of the rotation's axis, reversed, and the vector.
    p, q, r = 2 * (z * b - y * c), 2 * (x * c - z * a), 2 * (y * a - x * b)
    return (a + w * p - y * r + z * q,
            b + w * q - z * p + x * r,
            c + w * r - x * q + y * p)


def flu(frd: Vector) -> Vector:
    """Convert a body vector from forward, right, down to forward, left, up."""
    x, y, z = frd
    return x, 0.0 - y, 0.0 - z


def enu(ned: Vector) -> Vector:
    """Convert a vector from north, east, down to east, north, up."""
    north, east, down = ned
    return east, north, 0.0 - down


def enu_diagonal(ned: Vector) -> Vector:
    """Reorder values for the north, east and down axes to east, north, up."""
    north, east, down = ned
    return east, north, down


def flu_to_enu(frd_to_ned: Quaternion) -> Quaternion:
    """Convert an attitude from FRD to NED axes into a rotation from FLU to ENU axes."""
    w, x, y, z = frd_to_ned
    return Quaternion(_SQRT_HALF * (w + z), _SQRT_HALF * (x + y),
                      _SQRT_HALF * (x - y), _SQRT_HALF * (w - z))


def flu_angles(frd: Vector) -> Vector:
    """
    Convert roll, pitch and yaw of FRD axes in NED to those of FLU axes in ENU (radians).

    The yaw is from -pi to pi, as are all yaws that are published.
    """
    roll, pitch, yaw = frd
    return roll, 0.0 - pitch, math.remainder(math.pi / 2 - yaw, math.tau)


def frd_angles(frd: Vector) -> Vector:
    """Return roll, pitch and yaw with a yaw from -pi to pi (radians)."""
    roll, pitch, yaw = frd
    return roll, pitch, math.remainder(yaw, math.tau)


def _identity(value: Any) -> Any:
    return value


@dataclass(frozen=True)
class Convention:
    """Converts vectors, variances and rotations from the axes of the device."""

    body: Callable[[Vector], Vector]                    # a vector in body axes
    world: Callable[[Vector], Vector]                   # a vector in navigation axes
    diagonal: Callable[[Vector], Vector]                # variances about navigation axes
    orientation: Callable[[Quaternion], Quaternion]     # body to navigation axes
    axes: Quaternion                                    # body axes to forward, left, up
    angles: Callable[[Vector], Vector]                  # roll, pitch, yaw


CONVENTIONS = {
    'enu': Convention(flu, enu, enu_diagonal, flu_to_enu, NO_ROTATION, flu_angles),
    'ned': Convention(_identity, _identity, _identity, _identity, _HALF_TURN_ABOUT_X, frd_angles),
}
