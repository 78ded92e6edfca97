# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the covariance matrices."""

from bahrs_driver.convert import covariance
import pytest


def test_diagonal():
    """The matrix is in row-major order, with zeros beside the variances."""
    assert covariance.diagonal((1.0, 2.0, 3.0)) == (1, 0, 0, 0, 2, 0, 0, 0, 3)


def test_a_vector_has_the_variance_of_its_components():
    """Each variance is the square of the deviation."""
    matrix = covariance.of_vector((1.0, 1.0, 1.0), 0.5)
    assert matrix == (0.25, 0, 0, 0, 0.25, 0, 0, 0, 0.25)


def test_factors_multiply_the_variances():
    """Each component has its own factor."""
    assert covariance.of_vector((1.0, 100.0, 1.0), 0.5)[4] == 25


def test_a_lone_missing_component_has_an_unknown_variance():
    """The others keep their variance, and the first element is not -1."""
    matrix = covariance.of_vector((None, 1.0, 1.0), 0.5)
    assert matrix == (1e6, 0, 0, 0, 0.25, 0, 0, 0, 0.25)


def test_a_vector_without_components_is_not_reported():
    """By REP-145, the first element is -1."""
    assert covariance.of_vector((None, None, None), 0.5)[0] == -1


def test_covariance_of_the_orientation():
    """A missing deviation is unknown; without any, the matrix is all zeros."""
    assert covariance.of_orientation((0.1, 0.2, 0.3)) == pytest.approx(
        (0.01, 0, 0, 0, 0.04, 0, 0, 0, 0.09))
    assert covariance.of_orientation((0.1, None, 0.3))[4] == 1e6
    assert covariance.of_orientation((None, None, None)) == (0,) * 9


def test_only_z_is_known():
    """The third variance is that of z, the other five are unknown."""
    matrix = covariance.of_z_only(2, 3.0)
    assert len(matrix) == 36
    assert [matrix[7 * i] for i in range(6)] == [1e6, 1e6, 9.0, 1e6, 1e6, 1e6]
    assert sum(map(bool, matrix)) == 6
