# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the derived magnetic field."""

import math

from bahrs_driver.convert.axes import CONVENTIONS, flu_to_enu, quaternion_from_euler
from bahrs_driver.convert.bahrs.magnetic import derived_field, north_east_down
from hypothesis import given, strategies as st
import numpy as np
import pytest

ENU, NED = CONVENTIONS['enu'], CONVENTIONS['ned']


@pytest.mark.parametrize('heading, expected', [
    (0, (50, 0, 0)), (90, (0, 50, 0)), (180, (-50, 0, 0)), (270, (0, -50, 0))])
def test_level_flu_field_points_north(heading, expected):
    """For a heading of east, north is to the left: positive y."""
    field, _ = derived_field(0, 0, math.radians(heading), 0.1, 50e-6, 0.0, ENU)
    assert np.array(field) * 1e6 == pytest.approx(expected, abs=1e-9)


def test_dip_points_down():
    """In ENU up is positive, so the vertical component is negative."""
    field, _ = derived_field(0, 0, 0, 0.1, 50e-6, math.radians(60), ENU)
    assert field == pytest.approx((25e-6, 0, -50e-6 * math.sin(math.radians(60))))


def test_heading_computed_from_the_field_is_the_heading():
    """A tilt-compensated compass finds the heading at an arbitrary attitude."""
    roll, pitch, heading = 0.3, -0.4, 4.0
    field, _ = derived_field(roll, pitch, heading, 0.1, 50e-6, 0.9, NED)
    x, y, z = field
    level_x = (x * math.cos(pitch) + y * math.sin(roll) * math.sin(pitch)
               + z * math.cos(roll) * math.sin(pitch))
    level_y = y * math.cos(roll) - z * math.sin(roll)
    assert math.atan2(-level_y, level_x) % (2 * math.pi) == pytest.approx(heading)


@given(*[st.floats(-math.pi, math.pi)] * 3)
def test_rotation_is_the_inverse_of_the_quaternion(roll, pitch, heading):
    """The matrix and the quaternion of `axes` describe the same attitude."""
    w, x, y, z = quaternion_from_euler(roll, pitch, heading)
    to_ned_down = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    downward = [direction[2] for direction in north_east_down(roll, pitch, heading)]
    assert downward == pytest.approx(to_ned_down, abs=1e-12)


def test_only_the_direction_across_the_field_is_known():
    """Level, heading north, in FLU: y follows from the heading, x and z are unknown."""
    _, matrix = derived_field(0, 0, 0, 0.1, 50e-6, 0.0, ENU)
    assert np.array(matrix).reshape(3, 3) == pytest.approx(
        np.diag([2.5e-9, 2.5e-11, 2.5e-9]), abs=1e-20)


def test_the_covariance_rotates_with_the_body():
    """At any attitude it is symmetric and has the same eigenvalues."""
    _, matrix = derived_field(0.3, -0.4, 4.0, 0.1, 50e-6, 0.0, ENU)
    matrix = np.array(matrix).reshape(3, 3)
    assert matrix == pytest.approx(matrix.T)
    assert sorted(np.linalg.eigvalsh(matrix)) == pytest.approx([2.5e-11, 2.5e-9, 2.5e-9])


def test_without_accuracy_the_covariance_is_unknown():
    """It is all zeros."""
    _, matrix = derived_field(0, 0, 0, None, 50e-6, 0.0, ENU)
    assert matrix == (0,) * 9


def test_field_and_published_orientation_agree():
    """Rotated by the orientation, the field points north: y of ENU."""
    roll, pitch, heading = 0.3, -0.4, 4.0
    (x, y, z), _ = derived_field(roll, pitch, heading, 0.1, 50e-6, 0.0, ENU)
    w, a, b, c = flu_to_enu(quaternion_from_euler(roll, pitch, heading))
    north = 2 * (a * b + w * c) * x + (1 - 2 * (a * a + c * c)) * y + 2 * (b * c - w * a) * z
    assert north == pytest.approx(50e-6)


@pytest.mark.parametrize('dip', [0.0, 0.5, 1.1, -1.1])
@pytest.mark.parametrize('convention', [ENU, NED])
def test_errors_of_the_attitude_stay_within_the_covariance(convention, dip):
    """Across the field, tilt adds the vertical component; along it, the variance is unknown."""
    strength, (north, east, down) = 50e-6, (0.01, 0.02, 0.03)
    roll, pitch, heading = 0.3, -0.5, 2.0
    field, matrix = derived_field(
        roll, pitch, heading, down, strength, dip, convention, north)
    to_body = np.array(north_east_down(roll, pitch, heading)).T
    errors = np.random.default_rng(7).normal(size=(200_000, 3)) * (north, east, down)
    earth = np.array([strength * math.cos(dip), 0.0, strength * math.sin(dip)])
    # To first order, as covariances are.
    seen = (to_body @ (earth - np.cross(errors, earth)).T).T
    # The axes turn linearly: the rows are the images of the unit vectors.
    seen = seen @ np.array([convention.body(tuple(unit)) for unit in np.eye(3).tolist()])
    assert seen.mean(axis=0) == pytest.approx(np.array(field), abs=1e-8)
    published, sampled = np.array(matrix).reshape(3, 3), np.cov(seen.T)
    across = np.array(convention.body(tuple(to_body[:, 1])))
    assert across @ published @ across == pytest.approx(across @ sampled @ across, rel=0.02)
    assert across @ published @ across == pytest.approx(
        (strength * math.cos(dip) * down) ** 2 + (strength * math.sin(dip) * north) ** 2)
    assert min(np.linalg.eigvalsh(published - 0.98 * sampled)) > 0


def test_without_a_known_tilt_the_vertical_component_is_unknown():
    """Without dip there is no vertical component."""
    for dip in (0.0, 1.0):
        _, matrix = derived_field(0, 0, 0, 0.1, 50e-6, dip, NED, None)
        assert matrix[4] == pytest.approx(
            (50e-6 * math.cos(dip) * 0.1) ** 2 + (50e-6 * math.sin(dip)) ** 2)
