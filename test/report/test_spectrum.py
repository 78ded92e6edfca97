# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of lines in a spectrum: found where they are, and never at half the sample rate."""

from bahrs_driver.report.spectrum import Lines, lines
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

PERIOD = 0.005
RATE = 1 / PERIOD


def vibrating(frequency, amplitude=0.05, count=12_000, phase=0.3, seed=1):
    """Return white noise and a vibration, sampled."""
    time = PERIOD * np.arange(count)
    return np.random.default_rng(seed).normal(0.0, 0.01, count) \
        + amplitude * np.sin(2 * np.pi * frequency * time + phase)


def test_white_noise_has_no_line():
    """Not even a weak one."""
    assert lines(vibrating(0.0, 0.0), PERIOD) == Lines(None, False)


@pytest.mark.parametrize('frequency', [100.0, 99.97, 100.04, 300.0])
def test_half_the_sample_rate_is_left_out(frequency):
    """Its true frequency cannot be known, nor that of what the window smears beside it."""
    assert lines(vibrating(frequency), PERIOD) == Lines(None, True)


def test_a_weaker_line_beside_one_at_half_the_rate():
    """Only the strongest is reported."""
    found = lines(vibrating(100.0, 0.5) + vibrating(22.9, 0.03, seed=2), PERIOD)
    assert found.strongest == pytest.approx(22.9, abs=0.1) and found.at_half_rate


@settings(max_examples=30)
@given(frequency=st.floats(1.5, 1000.0), count=st.integers(4_000, 14_000))
def test_a_line_is_found_where_it_appears(frequency, count):
    """Above half the sample rate at its alias; an odd number of samples makes no difference."""
    alias = abs((frequency + RATE / 2) % RATE - RATE / 2)
    found = lines(vibrating(frequency, count=count), PERIOD)
    if 1.5 < alias < RATE / 2 - 0.4:
        assert found.strongest == pytest.approx(alias, abs=0.1)
    elif found.strongest is not None:
        assert found.strongest < RATE / 2 - 0.1
