# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test that a curve of fewer points looks the same."""

from bahrs_driver.report.decimate import angle_envelope, envelope
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
import numpy as np

SECONDS = 0.01 * np.arange(100_000)


def test_single_peaks_are_drawn():
    """A peak and a dip of one sample each are kept among 100,000 values."""
    values = np.zeros(100_000)
    values[12_345], values[54_321] = 7.0, -3.0
    times, drawn = envelope(SECONDS, values)
    assert len(times) == len(drawn) <= 1_802
    assert (np.nanmax(drawn), np.nanmin(drawn)) == (7.0, -3.0)
    assert abs(times[np.nanargmax(drawn)] - SECONDS[12_345]) < 2.0


def test_few_values_are_unchanged():
    """A curve with fewer points than buckets is not reduced."""
    times, drawn = envelope(SECONDS[:50], SECONDS[:50] ** 2)
    assert np.array_equal(times, SECONDS[:50]) and np.array_equal(drawn, SECONDS[:50] ** 2)


def test_gaps_interrupt_the_line():
    """Gaps in time and missing values interrupt it."""
    later = np.where(SECONDS > 500.0, SECONDS + 100.0, SECONDS)
    for count in (100_000, 2_000):
        times, drawn = envelope(later[-count - 49_000:], np.ones(100_000)[-count - 49_000:])
        assert np.isnan(drawn).any() and np.all(np.diff(times) >= 0)
    values = np.where((SECONDS > 300) & (SECONDS < 400), np.nan, 1.0)
    times, drawn = envelope(SECONDS, values)
    assert np.isnan(drawn[(times > 302) & (times < 398)]).all()


@given(values=arrays(float, st.integers(1, 5000), elements=st.floats(-1e6, 1e6)))
def test_extremes_are_kept(values):
    """Minimum and maximum of the values are drawn."""
    _, drawn = envelope(0.1 * np.arange(len(values)), values, buckets=50)
    assert (np.nanmin(drawn), np.nanmax(drawn)) == (values.min(), values.max())


def test_angle_that_passes_north():
    """No line is drawn from 360 to 0 degrees."""
    heading = (350.0 + 0.001 * np.arange(100_000)) % 360.0
    times, drawn = angle_envelope(SECONDS, heading)
    jumps = abs(np.diff(drawn))
    assert np.nanmax(jumps) < 5.0 and np.isnan(drawn).any()
    assert len(times) == len(drawn)
