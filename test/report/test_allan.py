# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the Allan deviation: against published figures, and noise that is known."""

from bahrs_driver.report.allan import allan
import numpy as np
import pytest

PERIOD = 0.005


def published():
    """Return the 1,000 numbers that NIST Special Publication 1065 gives its figures for."""
    numbers = [1234567890]
    while len(numbers) < 1000:
        numbers.append(16807 * numbers[-1] % 2147483647)
    return np.array(numbers) / 2147483647


@pytest.mark.parametrize('tau, deviation', [
    (1, 2.922319e-1), (10, 9.159953e-2), (100, 3.241343e-2)])
def test_published_figures(tau, deviation):
    """Of the overlapping Allan deviation."""
    curve = allan(published(), 1.0)
    assert curve.deviation[np.flatnonzero(curve.tau == tau)] == pytest.approx(deviation, rel=1e-6)


def white(density, count=400_000, seed=1):
    """Return white noise of a density in unit * sqrt(s)."""
    return np.random.default_rng(seed).normal(0.0, density / np.sqrt(PERIOD), count)


def test_white_noise_is_read_off():
    """And nothing that is not there."""
    curve = allan(white(0.002), PERIOD)
    assert curve.white_noise == pytest.approx(0.002, rel=0.03)
    assert curve.random_walk is None


def test_a_random_walk_is_read_off():
    """Where it has become stronger than the white noise."""
    steps = np.random.default_rng(2).normal(0.0, 0.0005 * np.sqrt(PERIOD), 400_000)
    curve = allan(white(0.0005) + np.cumsum(steps), PERIOD)
    assert curve.white_noise == pytest.approx(0.0005, rel=0.1)
    assert curve.random_walk == pytest.approx(0.0005, rel=0.3)
    assert curve.bias_instability is not None


def test_too_few_values():
    """Nothing is read off them."""
    curve = allan(white(1.0, count=12), PERIOD)
    assert (curve.white_noise, curve.bias_instability, curve.random_walk) == (None, None, None)


def test_values_that_do_not_change():
    """There is no noise, and no curve."""
    assert len(allan(np.full(1000, 3.0), PERIOD).tau) == 0
