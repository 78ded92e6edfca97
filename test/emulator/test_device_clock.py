# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the device clock, with literal values."""

from bahrs_driver.emulator.device_clock import DeviceClock
import pytest


def test_a_perfect_clock_agrees_with_true_time():
    """One second is a million microseconds."""
    clock = DeviceClock(1)
    clock.advance(1_000_000)
    assert (clock.time, clock.reading_us) == (1.0, 1_000_000)


@pytest.mark.parametrize(('ppm', 'true'), [(100.0, 999.90001), (-250.0, 1000.25006)])
def test_a_fast_clock_reaches_its_reading_early(ppm, true):
    """A positive drift is a clock that runs too fast."""
    clock = DeviceClock(1, drift_ppm=ppm)
    for _ in range(200_000):
        clock.advance(5_000)
    assert clock.reading_us == 1_000_000_000
    assert clock.time == pytest.approx(true, abs=1e-5)


def test_a_reading_between_samples_follows_the_drift():
    """Microseconds, rounded, on either side of the present."""
    clock = DeviceClock(1, drift_ppm=1000.0, start_us=7)
    clock.restart(10.0)
    assert clock.reading_us == 7
    assert clock.reading_at(10.001) == 7 + 1001
    assert clock.reading_at(9.999) == 7 - 1001


def test_the_drift_can_be_changed_while_it_runs():
    """Earlier readings do not change."""
    clock = DeviceClock(1)
    clock.advance(1_000_000)
    clock.drift_ppm = 1e5
    clock.advance(1_100_000)
    assert clock.time == pytest.approx(2.0)


def test_wander_is_slow_and_seeded():
    """One ppm per square root of a second drifts by some ppm in a hundred seconds."""
    def strayed(seed):
        clock = DeviceClock(seed, wander_ppm=1.0)
        for _ in range(20_000):
            clock.advance(5_000)
        return (clock.time - 100.0) / 100.0 * 1e6

    assert strayed(1) == strayed(1) != strayed(2)
    assert 0.1 < max(abs(strayed(seed)) for seed in range(5)) < 50.0


def test_a_restart_sets_the_reading_back():
    """The reading is that after power-on."""
    clock = DeviceClock(1, start_us=500)
    clock.advance(1_000)
    clock.restart(3.0)
    assert (clock.time, clock.reading_us) == (3.0, 500)
