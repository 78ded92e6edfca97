# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the Allan deviation with published values and simulated noise."""

from bahrs_driver.report.allan import allan_deviation
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

PERIOD = 0.005


def published_numbers():
    """Return the 1,000 numbers of the example in NIST Special Publication 1065."""
    numbers = [1234567890]
    while len(numbers) < 1000:
        numbers.append(16807 * numbers[-1] % 2147483647)
    return np.array(numbers) / 2147483647


@pytest.mark.parametrize('tau, deviation', [
    (1, 2.922319e-1), (10, 9.159953e-2), (100, 3.241343e-2)])
def test_published_values(tau, deviation):
    """The overlapping Allan deviation equals the values in the publication."""
    curve = allan_deviation(published_numbers(), 1.0)
    assert curve.deviation[np.flatnonzero(curve.tau == tau)] == pytest.approx(deviation, rel=1e-6)


def white_noise(density, count=400_000, seed=1):
    """Return white noise of a density in unit * sqrt(s)."""
    return np.random.default_rng(seed).normal(0.0, density / np.sqrt(PERIOD), count)


def random_walk(walk, seconds, density=0.0005, seed=2):
    """Return white noise whose mean does a random walk."""
    count = round(seconds / PERIOD)
    steps = np.random.default_rng(seed).normal(0.0, walk * np.sqrt(PERIOD), count)
    return white_noise(density, count, seed + 1) + np.cumsum(steps)


def test_white_noise():
    """N is read; B and K, which are not in the noise, are not."""
    curve = allan_deviation(white_noise(0.002), PERIOD)
    assert curve.white_noise.value == pytest.approx(0.002, rel=0.03)
    assert curve.bias_instability.value is None
    assert curve.random_walk == (None, 'not rising up to 222 s')


def test_random_walk():
    """K is read if the record is long enough for the walk to exceed the white noise."""
    curve = allan_deviation(random_walk(0.0005, 2000.0), PERIOD)
    assert curve.white_noise.value == pytest.approx(0.0005, rel=0.1)
    assert curve.random_walk.value == pytest.approx(0.0005, rel=0.3)
    assert curve.bias_instability.value is not None


@pytest.mark.parametrize('seed', range(5))
def test_four_minutes_are_too_short_for_a_random_walk(seed):
    """No reliable decade of the curve rises: the reason gives the time needed."""
    curve = allan_deviation(random_walk(0.0005, 240.0, seed=seed), PERIOD)
    value, reason = curve.random_walk
    assert value is None and reason.startswith('rest too short, needs ')
    assert int(reason.split()[-2]) > 4
    assert curve.tau[curve.reliable][-1] == pytest.approx(240.0 / 9, rel=0.01)
    assert curve.white_noise.value == pytest.approx(0.0005, rel=0.1)


def test_linear_drift_is_no_random_walk():
    """The slope of a drift, as of a device that warms up, is +1."""
    drift = white_noise(0.0005) + 1e-5 * PERIOD * np.arange(400_000)
    assert allan_deviation(drift, PERIOD).random_walk == (None, 'no slope of +1/2')


@settings(max_examples=25)
@given(seconds=st.floats(60.0, 900.0), walk=st.floats(1e-5, 5e-3), seed=st.integers(0, 99))
def test_coefficients_are_accurate(seconds, walk, seed):
    """A coefficient comes from reliable points and is near the truth, or there is a reason."""
    curve = allan_deviation(random_walk(walk, seconds, seed=seed), PERIOD)
    assert curve.white_noise.value == pytest.approx(0.0005, rel=0.2)
    for value, reason in (curve.white_noise, curve.bias_instability, curve.random_walk):
        assert (value is None) == bool(reason)
    lowest = curve.tau[np.argmin(np.where(curve.reliable, curve.deviation, np.inf))]
    if curve.random_walk.value is not None:
        assert curve.random_walk.value == pytest.approx(walk, rel=0.5)
        assert seconds > 80 * lowest
    if curve.bias_instability.value is not None:
        assert seconds > 25 * lowest


def test_too_few_values():
    """No coefficient is read from a short record."""
    curve = allan_deviation(white_noise(1.0, count=12), PERIOD)
    assert curve.white_noise == curve.bias_instability == curve.random_walk == (
        None, 'rest too short')


def test_constant_values():
    """Without noise there is no curve."""
    curve = allan_deviation(np.full(1000, 3.0), PERIOD)
    assert len(curve.tau) == 0 and curve.white_noise == (None, 'no noise')
