# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the smoother, compared with the live clock and simulated truth."""

import random

from bahrs_driver.clock import ArrivalClock, ClockOptions, ExchangeClock, SampleClock
from bahrs_driver.clock.estimation.rts_smoother import Measurement, rts_smooth
from bahrs_driver.clock.estimation.smoother_input import SmootherInput
from bahrs_driver.protocol.bahrs.roles import ROLES
from clock_simulation import Case
import pytest
from support.simulated import simulated

S = 1_000_000_000
SAMPLE = 5_000_000


def smoothed(samples):
    """Return the smoothed estimate by (device time, bound) pairs."""
    first_pass = SmootherInput()
    first_pass.restart()
    for device, bound in samples:
        first_pass.feed(device, bound)
    smooth = first_pass.smoothed()
    smooth.restart()
    smooth.feed(*samples[0])
    return smooth


def test_smoother_of_a_straight_line():
    """Without noise, only rounding makes an error."""
    items = [Measurement(i * S, 1000.0 + 2e-5 * i * S, 100.0) for i in range(50)]
    for item, (offset, skew) in zip(items, rts_smooth(items, 1e12)):
        assert offset == pytest.approx(item.offset, abs=1.0)
        assert skew == pytest.approx(2e-5, abs=1e-8)


def test_smoother_uses_both_sides():
    """It is closer to the line than the noisy measurements, even at the beginning."""
    source = random.Random(1)
    items = [Measurement(i * S, source.gauss(0, 1e5), 1e10) for i in range(400)]
    offsets = [offset for offset, _ in rts_smooth(items, 1e14)]
    assert max(map(abs, offsets)) < 5e4
    assert max(map(abs, offsets[:20])) < 5e4


def test_smoother_jumps_where_the_model_allows_it():
    """It does not jump anywhere else."""
    items = [Measurement(i * S, 1e6 * (i >= 20), 100.0, 1e14 * (i == 20)) for i in range(40)]
    for item, (offset, _) in zip(items, rts_smooth(items, 1e12)):
        assert offset == pytest.approx(item.offset, abs=100.0)


@pytest.mark.parametrize('case', [
    Case(30.0), Case(30.0, 'packets'), Case(30.0, 0.001), Case(30.0, overload=(10.0, 20.0)),
    Case(30.0, overload=(0.0, 12.0)), Case(30.0, restarts=(14.0,)), Case(30.0, loss=0.02),
    Case(30.0, bad_counters=0.02, bad_times=0.05), Case(30.0, drift_ppm=-200.0),
    Case(30.0, pause_before=16, pause=2.7),
], ids=['16 ms', 'packets', '1 ms', 'overload', 'early overload', 'restart', 'loss',
        'bad counters', 'drift', 'pause'])
def test_the_smoother_is_better_than_the_live_estimate(case):
    """This holds from the first second to the last, in each case."""
    first_pass = SmootherInput()
    live = simulated(case, 7, estimate=first_pass)
    smooth = simulated(case, 7, estimate=first_pass.smoothed())
    assert smooth.state.epochs == live.state.epochs
    assert smooth.backward == 0 and smooth.future == 0
    assert len(smooth.errors) >= len(live.errors) - 1
    assert smooth.wander(0.0) <= max(live.wander(0.0), 10.0)
    assert smooth.wander(0.0) < 40.0 or case.bad_times


def test_both_levels_of_a_changed_path_are_found():
    """The delay changes by two milliseconds, up or down."""
    for first, second in ((0, 2_000_000), (2_000_000, 0)):
        samples = [(i * SAMPLE, i * SAMPLE + 10 ** 12 + (first if i < 20_000 else second))
                   for i in range(40_000)]
        smooth = smoothed(samples)
        for index in (0, 10_000, 19_000, 21_000, 39_999):
            device, bound = samples[index]
            assert abs(smooth.host_time(device) - bound) < 30_000


def test_a_single_early_sample_is_rejected():
    """A corrupted counter may make a sample early."""
    samples = [(i * SAMPLE, i * SAMPLE + 10 ** 12 - 50_000_000 * (i == 5000))
               for i in range(10_000)]
    smooth = smoothed(samples)
    assert max(abs(smooth.host_time(device) - device - 10 ** 12)
               for device, _ in samples) < 30_000


def test_one_sample_suffices_for_a_curve():
    """Its skew is 0."""
    smooth = smoothed([(0, 1000)])
    assert smooth.started and smooth.host_time(S) == S + 1000


def test_both_passes_use_new_clocks():
    """They have the same options."""
    smoothing = SampleClock(ROLES, ClockOptions(source='sync_pulse')).smoothing()
    for clock in (smoothing.first_pass, smoothing.second_pass()):
        assert clock.state().source == 'sync_pulse' and clock.state().epochs == 0


@pytest.mark.parametrize('clock', [ArrivalClock(), ExchangeClock(8)])
def test_a_clock_without_an_estimate_needs_one_pass(clock):
    """Nothing can be smoothed."""
    assert clock.smoothing() is None


@pytest.mark.parametrize('late_us', [100, 250, 500, 3000])
def test_a_late_beginning_does_not_affect_the_rest(late_us):
    """The first samples are often late, even if all others are read in time."""
    source = random.Random(late_us)
    samples = [(index * 5_000_000, 10 ** 12 + round(
        index * 5_000_000 * (1 - 30e-6) + source.uniform(0, 30_000)
        + (late_us * 1000 if index < 90 else 0))) for index in range(4000)]
    smooth = smoothed(samples)
    for index in range(0, 4000, 100):
        device = index * 5_000_000
        error = smooth.host_time(device) - 10 ** 12 - device * (1 - 30e-6)
        assert abs(error) < 25_000, index


def test_a_short_epoch_of_late_samples_ends():
    """
    A host that is seconds late may look like a device whose clock was set twice.

    The curve of the samples in between has a wrong slope, and must not be used after them.
    """
    first_pass, truth = SmootherInput(), 10 ** 12
    epochs = [(0, 20_000, 0), (20_000, 21_000, 1_400_000_000), (21_000, 40_000, 700_000_000)]
    samples = []
    for begin, end, late in epochs:
        first_pass.restart()
        samples.append([])
        for index in range(begin, end):
            # The backlog shrinks within the second one and, at first, within the third.
            left = max(0, late - (index - begin) * 160_000)
            samples[-1].append((index * SAMPLE, index * SAMPLE + truth + left))
            first_pass.feed(*samples[-1][-1])
    smooth = first_pass.smoothed()
    for epoch in samples:
        smooth.restart()
        smooth.feed(*epoch[0])
    last = samples[-1][-1][0]
    assert abs(smooth.host_time(last) - last - truth) < 30_000
