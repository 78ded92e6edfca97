# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the change of axes, compared with values computed by hand."""

import math

from bahrs_driver.convert.axes import (
    CONVENTIONS,
    enu,
    enu_diagonal,
    flu,
    flu_angles,
    flu_to_enu,
    frd_angles,
    Quaternion,
    quaternion_from_euler,
)
from hypothesis import given, strategies as st
import pytest

angles = st.floats(-math.pi, math.pi)


def euler_degrees(quaternion: Quaternion) -> tuple[float, float, float]:
    """Return roll, pitch and yaw by the textbook formula."""
    w, x, y, z = quaternion
    return tuple(map(math.degrees, (
        math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x)))),
        math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))))


def rotate(quaternion: Quaternion, vector: tuple[float, float, float]) -> list[float]:
    """Return the vector rotated by the quaternion, as q v q*."""
    w, x, y, z = quaternion
    a, b, c = vector
    return [
        (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c,
        2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c,
        2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c]


@pytest.mark.parametrize('ned, expected', [
    ((10, 20, 30), (10, -20, 60)),
    ((0, 0, 0), (0, 0, 90)),
    ((0, 0, 90), (0, 0, 0)),
    ((0, 0, 180), (0, 0, -90)),
    ((0, 0, 270), (0, 0, 180)),
    ((-45, 0, 90), (-45, 0, 0)),
    ((0, 60, 90), (0, -60, 0)),
])
def test_attitude_in_ned_is_converted_to_enu(ned, expected):
    """Roll stays, pitch changes its sign, and yaw is counterclockwise from east."""
    quaternion = flu_to_enu(quaternion_from_euler(*map(math.radians, ned)))
    found = euler_degrees(quaternion)
    for a, b in zip(found, expected):
        assert math.remainder(a - b, 360) == pytest.approx(0, abs=1e-9)


@given(angles, angles, angles, st.tuples(*[st.floats(-10, 10)] * 3))
def test_rotation_commutes_with_the_change_of_axes(roll, pitch, yaw, vector):
    """Rotate in NED and change the axes, or change the axes and rotate in ENU."""
    quaternion = quaternion_from_euler(roll, pitch, yaw)
    through_ned = enu(tuple(rotate(quaternion, vector)))
    through_enu = rotate(flu_to_enu(quaternion), flu(vector))
    assert through_enu == pytest.approx(through_ned, abs=1e-9)


@given(angles, angles, angles)
def test_quaternions_have_unit_length(roll, pitch, yaw):
    """This holds in both conventions."""
    for convention in CONVENTIONS.values():
        quaternion = convention.orientation(quaternion_from_euler(roll, pitch, yaw))
        assert sum(part * part for part in quaternion) == pytest.approx(1)


def test_axes_of_vectors():
    """Body vectors become forward, left, up; world vectors east, north, up."""
    assert flu((1.0, 2.0, 3.0)) == (1.0, -2.0, -3.0)
    assert enu((1.0, 2.0, 3.0)) == (2.0, 1.0, -3.0)
    assert enu_diagonal((1.0, None, 3.0)) == (None, 1.0, 3.0)


def test_ned_changes_nothing():
    """The device itself uses NED."""
    ned, vector, turn = CONVENTIONS['ned'], (1.0, 2.0, 3.0), Quaternion(0.5, 0.5, -0.5, 0.5)
    assert (ned.body(vector), ned.world(vector), ned.diagonal(vector)) == (vector,) * 3
    assert ned.orientation(turn) == turn


@pytest.mark.parametrize('convert, orientation', [
    (flu_angles, flu_to_enu), (frd_angles, lambda quaternion: quaternion)])
@given(roll=angles, pitch=angles, yaw=st.floats(-20, 20))
def test_angles_are_those_of_the_orientation(convert, orientation, roll, pitch, yaw):
    """Both signs of a quaternion are the same; yaw is from -180 to 180 degrees."""
    found = convert((roll, pitch, yaw))
    expected = orientation(quaternion_from_euler(roll, pitch, yaw))
    overlap = sum(a * b for a, b in zip(quaternion_from_euler(*found), expected))
    assert abs(overlap) == pytest.approx(1.0)
    assert -math.pi <= found[2] <= math.pi
