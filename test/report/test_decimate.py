# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of drawing with fewer points: nothing that can be seen is lost."""

from bahrs_driver.report.decimate import angle_envelope, envelope, runs
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
import numpy as np

SECONDS = 0.01 * np.arange(100_000)


def test_a_single_peak_is_drawn():
    """Among a hundred thousand values, and one downward."""
    values = np.zeros(100_000)
    values[12_345], values[54_321] = 7.0, -3.0
    times, drawn = envelope(SECONDS, values)
    assert len(times) == len(drawn) <= 1_802
    assert (np.nanmax(drawn), np.nanmin(drawn)) == (7.0, -3.0)
    assert abs(times[np.nanargmax(drawn)] - SECONDS[12_345]) < 2.0


def test_few_values_are_all_drawn():
    """As they are."""
    times, drawn = envelope(SECONDS[:50], SECONDS[:50] ** 2)
    assert np.array_equal(times, SECONDS[:50]) and np.array_equal(drawn, SECONDS[:50] ** 2)


def test_gaps_interrupt_the_line():
    """In time, and where values are missing."""
    later = np.where(SECONDS > 500.0, SECONDS + 100.0, SECONDS)
    for count in (100_000, 2_000):
        times, drawn = envelope(later[-count - 49_000:], np.ones(100_000)[-count - 49_000:])
        assert np.isnan(drawn).any() and np.all(np.diff(times) >= 0)
    values = np.where((SECONDS > 300) & (SECONDS < 400), np.nan, 1.0)
    times, drawn = envelope(SECONDS, values)
    assert np.isnan(drawn[(times > 302) & (times < 398)]).all()


@given(values=arrays(float, st.integers(1, 5000), elements=st.floats(-1e6, 1e6)))
def test_the_extremes_stay(values):
    """Whatever the values."""
    _, drawn = envelope(0.1 * np.arange(len(values)), values, buckets=50)
    assert (np.nanmin(drawn), np.nanmax(drawn)) == (values.min(), values.max())


def test_an_angle_that_passes_north():
    """Is not drawn across the picture."""
    heading = (350.0 + 0.001 * np.arange(100_000)) % 360.0
    times, drawn = angle_envelope(SECONDS, heading)
    jumps = abs(np.diff(drawn))
    assert np.nanmax(jumps) < 5.0 and np.isnan(drawn).any()
    assert len(times) == len(drawn)


def test_runs_of_a_state():
    """One after the other."""
    assert runs(np.arange(6.0), np.array([1, 1, 0, 0, 2, 2])) == [
        (0.0, 2.0, 1), (2.0, 4.0, 0), (4.0, 5.0, 2)]
    assert runs(np.empty(0), np.empty(0)) == []
