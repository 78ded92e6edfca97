# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the search for lines in a spectrum."""

from bahrs_driver.report.spectrum import find_lines, SpectralLines
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

PERIOD = 0.005
RATE = 1 / PERIOD


def vibrating(frequency, amplitude=0.05, count=12_000, phase=0.3, seed=1):
    """Return samples of white noise and a vibration."""
    time = PERIOD * np.arange(count)
    return np.random.default_rng(seed).normal(0.0, 0.01, count) \
        + amplitude * np.sin(2 * np.pi * frequency * time + phase)


def test_white_noise_has_no_line():
    """No peak of the noise counts as a line."""
    assert find_lines(vibrating(0.0, 0.0), PERIOD) == SpectralLines(None, False)


@pytest.mark.parametrize('frequency', [100.0, 99.97, 100.04, 300.0])
def test_line_at_the_nyquist_frequency(frequency):
    """It is reported separately, with the frequencies that the window spreads it over."""
    assert find_lines(vibrating(frequency), PERIOD) == SpectralLines(None, True)


def test_weaker_line_beside_one_at_the_nyquist_frequency():
    """Both are reported."""
    found = find_lines(vibrating(100.0, 0.5) + vibrating(22.9, 0.03, seed=2), PERIOD)
    assert found.strongest == pytest.approx(22.9, abs=0.1) and found.at_nyquist


@settings(max_examples=30)
@given(frequency=st.floats(1.5, 1000.0), count=st.integers(4_000, 14_000))
def test_line_is_found_at_its_alias(frequency, count):
    """The number of samples may be odd."""
    alias = abs((frequency + RATE / 2) % RATE - RATE / 2)
    found = find_lines(vibrating(frequency, count=count), PERIOD)
    if 1.5 < alias < RATE / 2 - 0.4:
        assert found.strongest == pytest.approx(alias, abs=0.1)
    elif found.strongest is not None:
        assert found.strongest < RATE / 2 - 0.1
