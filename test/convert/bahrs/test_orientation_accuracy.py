# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the covariance of the orientation, by literal values and by sampled errors."""

import math

from bahrs_driver.convert.axes import CONVENTIONS, quaternion_from_euler
from bahrs_driver.convert.bahrs.orientation_accuracy import LIFETIME, OrientationAccuracy
from bahrs_driver.protocol.bahrs.messages import Accuracy
import numpy as np
import pytest

ENU, NED = CONVENTIONS['enu'], CONVENTIONS['ned']
SAMPLES = 200_000


def accuracy(north=0.01, east=0.02, heading=0.03, convention=ENU, declination=0.0, fallback=0.0):
    """Return the accuracy after one accuracy message."""
    kept = OrientationAccuracy(convention, declination, fallback)
    kept.update(Accuracy(0, north, east, heading, 0))
    return kept


def square(matrix):
    """Return a flat matrix as an array."""
    return np.array(matrix).reshape(3, 3)


@pytest.mark.parametrize('convention, diagonal', [
    (ENU, [4e-4, 1e-4, 9e-4]), (NED, [1e-4, 4e-4, 9e-4])])
def test_order_of_the_axes(convention, diagonal):
    """The rotations are about east, north and up; in NED about north, east and down."""
    assert square(accuracy(convention=convention).matrix(1.0, 1.0)) == pytest.approx(
        np.diag(diagonal))


def test_declination_rotates_the_axes():
    """At 90 degrees magnetic north is true east; at 45 the two are correlated."""
    turned = square(accuracy(declination=math.pi / 2).matrix(1.0, 1.0))
    assert turned == pytest.approx(np.diag([1e-4, 4e-4, 9e-4]), abs=1e-12)
    between = square(accuracy(declination=math.pi / 4).matrix(1.0, 1.0))
    assert between == pytest.approx(np.array(
        [[2.5e-4, -1.5e-4, 0], [-1.5e-4, 2.5e-4, 0], [0, 0, 9e-4]]))


def test_without_a_heading_both_axes_have_the_larger_tilt():
    """The yaw is unknown, and so is the axis that points north."""
    kept = accuracy(declination=0.3)
    assert square(kept.matrix(1.0, None)) == pytest.approx(np.diag([4e-4, 4e-4, 1e6]))
    assert square(kept.matrix(100.0, None)) == pytest.approx(np.diag([4e-2, 4e-2, 1e6]))
    assert square(accuracy(north=None).matrix(1.0, None)) == pytest.approx(np.diag([1e6] * 3))


def test_the_fallback_replaces_unknown_deviations():
    """This holds before the first message, after the last, and for invalid values."""
    kept = OrientationAccuracy(ENU, 0.2, 0.1)
    assert square(kept.matrix(1.0, 1.0)) == pytest.approx(np.diag([0.01] * 3))
    assert square(kept.matrix(100.0, 1.0)) == pytest.approx(np.diag([1.0, 1.0, 0.01]))
    assert square(kept.matrix(1.0, None)) == pytest.approx(np.diag([0.01, 0.01, 1e6]))
    kept.update(Accuracy(0, 0.01, 0.02, 0.03, 0))
    for _ in range(LIFETIME):
        kept.count_navigation()
    assert kept.matrix(1.0, 1.0)[8] == pytest.approx(9e-4)
    kept.count_navigation()
    assert square(kept.matrix(1.0, 1.0)) == pytest.approx(np.diag([0.01] * 3))
    assert square(accuracy(heading=None, fallback=0.1).matrix(1.0, 1.0)) == pytest.approx(
        np.diag([4e-4, 1e-4, 0.01]))


def test_without_a_fallback_all_zeros_are_unknown():
    """By REP-145; beside known variances, and for a signal at risk, unknown is 1e6."""
    kept = OrientationAccuracy(ENU, 0.0, 0.0)
    assert kept.matrix(1.0, 1.0) == (0.0,) * 9
    assert square(kept.matrix(100.0, 1.0)) == pytest.approx(np.diag([1e6] * 3))
    assert square(accuracy(heading=None).matrix(1.0, 1.0)) == pytest.approx(
        np.diag([4e-4, 1e-4, 1e6]))


def rotations(w, x, y, z):
    """Return the matrices of quaternions, given as arrays of their components."""
    return np.moveaxis(np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]), (0, 1), (-2, -1))


def small_rotations(vectors):
    """Return the matrices of small rotations, an angle in rad about each axis."""
    half = vectors.T / 2
    return rotations(np.sqrt(1 - (half ** 2).sum(axis=0)), *half)


# World axes of each convention in north, east, down, and body axes in forward, right, down.
AXES = {'enu': (np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]]), np.diag([1, -1, -1])),
        'ned': (np.eye(3), np.eye(3))}


@pytest.mark.parametrize('name', AXES)
@pytest.mark.parametrize('declination', [0.0, 0.35, -1.2])
def test_errors_of_the_device_have_the_published_covariance(name, declination):
    """True attitudes are sampled about the reported one, in the axes of the device."""
    world, body = AXES[name]
    roll, pitch, heading = 0.3, -0.5, 2.0
    deviations = np.array([0.01, 0.02, 0.03])
    errors = np.random.default_rng(4).normal(size=(SAMPLES, 3)) * deviations
    to_magnetic = rotations(*quaternion_from_euler(roll, pitch, heading))
    c, s = math.cos(declination), math.sin(declination)
    to_true = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    true = world @ to_true @ small_rotations(errors) @ to_magnetic @ body
    convention = CONVENTIONS[name]
    estimate = rotations(*convention.orientation(
        quaternion_from_euler(roll, pitch, heading + declination)))
    off = true @ estimate.T
    vectors = np.array([off[:, 2, 1] - off[:, 1, 2], off[:, 0, 2] - off[:, 2, 0],
                        off[:, 1, 0] - off[:, 0, 1]]) / 2
    expected = square(accuracy(*deviations, convention, declination).matrix(1.0, 1.0))
    assert np.cov(vectors) == pytest.approx(expected, rel=0.03, abs=3e-6)
    assert np.linalg.eigvalsh(expected) == pytest.approx(sorted(deviations ** 2))
