# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the standard atmosphere, compared with its published tables."""

from bahrs_driver.convert.atmosphere import pressure, pressure_gradient, pressure_height
from hypothesis import given, strategies as st
import pytest


@pytest.mark.parametrize('height, expected', [
    (-1000, 113929.0), (0, 101325.0), (1000, 89874.6), (5000, 54019.9), (10000, 26436.3),
    (11000, 22632.1)])
def test_pressure_is_that_of_the_tables(height, expected):
    """ISO 2533, geopotential heights, six digits."""
    assert pressure(height) == pytest.approx(expected, rel=3e-6)


@given(st.floats(-6500, 10999))
def test_height_is_the_inverse_of_pressure(height):
    """The error is below a micrometre for all heights that a device can send."""
    assert pressure_height(pressure(height)) == pytest.approx(height, abs=1e-6)


@pytest.mark.parametrize('height', [-1000.0, 0.0, 537.2, 9000.0])
def test_gradient_is_the_slope_of_the_pressure(height):
    """The slope is a central difference."""
    slope = (pressure(height + 0.5) - pressure(height - 0.5))
    assert pressure_gradient(height) == pytest.approx(slope, rel=1e-6)
