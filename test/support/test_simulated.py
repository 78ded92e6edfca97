# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the whole clock on simulated devices whose true times are known."""

from typing import Any

from bahrs_driver.clock import ClockOptions
from clock_simulation import Case, ORIGIN, plain_ros
import pytest
from support.simulated import simulated

SECONDS = 40.0


@pytest.mark.parametrize('adapter', [0.016, 0.001, 'packets', 'plain'])
def test_figures_of_each_adapter(adapter: str | float) -> None:
    """Wander and settling are within the targets."""
    outcome = simulated(Case(SECONDS, adapter))
    assert outcome.wander(10) < 25
    assert max(map(abs, outcome.within(10))) < 150
    assert max(map(abs, outcome.within(2))) < 500
    assert outcome.backward == outcome.future == outcome.state.dropped == 0
    assert len(outcome.errors) == pytest.approx(200 * (SECONDS - 0.6), abs=100)


@pytest.mark.parametrize('label, expected', [(1, 'next'), (0, 'same')])
def test_convention_is_detected(label: int, expected: str) -> None:
    """Stamps are equally accurate with either convention."""
    outcome = simulated(Case(10, label=label))
    assert outcome.state.label == expected
    assert max(map(abs, outcome.within(2))) < 500


@pytest.mark.parametrize('adapter', [0.016, 'packets', 'plain'])
def test_a_restarted_device(adapter: str | float) -> None:
    """Below 5 ms at once, 0.5 ms after a second; reported once; the skew stays known."""
    outcome = simulated(Case(SECONDS, adapter, restarts=(20.0,)))
    assert max(map(abs, outcome.within(20.3, 21.9))) < 5000
    assert max(map(abs, outcome.within(21.9))) < 500
    assert outcome.state.epochs == 2
    assert outcome.notices == ["the device's clock has jumped: was the device restarted?"]


def stepped(raw: int) -> int:
    """Return the ROS time of a host that is set forward at 15 s and back at 25 s."""
    since = raw - ORIGIN
    return plain_ros(raw) + 500_000_000 * (since > 15e9) - 700_000_000 * (since > 25e9)


def test_a_host_that_is_set_is_followed_at_once() -> None:
    """Samples measured before a step and read after it have the new time; both are reported."""
    outcome = simulated(Case(SECONDS, ros=stepped))
    for begin, end in ((2, 15), (15.1, 25), (25.1, SECONDS)):
        assert max(map(abs, outcome.within(begin, end))) < 500
    assert outcome.backward == 1 and outcome.future == 0
    assert outcome.notices == ["the host's clock was set by +0.500000 s",
                               "the host's clock was set by -0.700000 s"]


def slewed(raw: int) -> int:
    """Return the ROS time of a host that is slewed by 500 ppm, and then by 8 %."""
    since = raw - ORIGIN
    return plain_ros(raw) + int(500e-6 * min(max(0, since - 15e9), 5e9)
                                + 0.08 * min(max(0, since - 25e9), 1e9))


def test_a_host_that_is_slewed_is_followed() -> None:
    """Even during the slew; at 8 % samples from before the last two reads are less accurate."""
    outcome = simulated(Case(SECONDS, ros=slewed))
    assert outcome.wander(10, 25) < 50
    assert max(map(abs, outcome.within(2, 25))) < 500
    assert max(map(abs, outcome.within(25))) < 2000
    assert not outcome.notices


@pytest.mark.parametrize('what', [
    {'loss': 0.01},
    {'loss': 0.01, 'adapter': 'packets'},
    {'temperature_ppm': 10.0},
    {'bad_times': 0.05},
    {'duplicates': 0.02},
    {'swaps': 0.05},
    {'overload': (15.0, 30.0)},
    {'drift_ppm': -200.0},
], ids=str)
def test_faults_without_effect(what: dict[str, Any]) -> None:
    """The errors are as promised a few seconds after the start."""
    outcome = simulated(Case(SECONDS, **what))
    assert outcome.wander(10) < 50
    assert max(map(abs, outcome.within(10))) < 150
    assert outcome.backward == outcome.future == 0
    assert outcome.state.epochs == 1


def test_damaged_counters_move_their_own_sample_only() -> None:
    """By as many samples as may have been lost, not by what their number says."""
    outcome = simulated(Case(SECONDS, bad_counters=0.01))
    errors = outcome.within(10)
    assert sum(abs(error) > 150 for error in errors) < 0.005 * len(errors)
    assert outcome.state.rejected_counters > 40
    assert outcome.wander(35) < 150


def test_a_late_first_time_message() -> None:
    """Samples wait for a while, then have arrival stamps until it comes."""
    outcome = simulated(Case(SECONDS, first_time_message=2.8))
    assert 200 * 2.1 < outcome.state.arrival_stamps < 200 * 2.8
    assert outcome.most_held < 120
    assert max(map(abs, outcome.within(5))) < 500
    assert outcome.wander(12) < 25
    assert outcome.backward == outcome.future == 0


def test_a_pause_after_the_first_time_message() -> None:
    """As in the recording; the samples before the pause do not wait for its end."""
    outcome = simulated(Case(SECONDS, pause_before=16, pause=2.7))
    assert outcome.state.epochs == 1 and outcome.state.arrival_stamps == 0
    assert max(map(abs, outcome.within(5))) < 500


PULSED = Case(SECONDS, pulses=(10.0, 25.0))


def test_pulses_remove_the_delay() -> None:
    """These errors include the constant delay, even after the pulses stop."""
    outcome = simulated(PULSED, options=ClockOptions(source='sync_pulse'))
    assert max(map(abs, outcome.within(14, 25))) < 10
    assert max(map(abs, outcome.within(31))) < 50
    assert outcome.state.in_use == 'device'
    assert outcome.state.pulses == 15
    assert outcome.notices == ['stamps follow the sync pulses',
                               'sync pulses are missing: stamps follow the arrival of samples']


def test_pulses_are_ignored_unless_enabled() -> None:
    """Diagnostics show the delay that they measure."""
    outcome = simulated(PULSED)
    assert outcome.wander(10) < 25
    assert outcome.state.pulse_delay_us == pytest.approx(50, abs=20)
    assert not outcome.notices


def test_a_constant_delay_is_unknown_unless_configured() -> None:
    """The delay from the sample to its first byte is 8 ms."""
    case = Case(SECONDS, delay=0.008)
    assert min(simulated(case).within(10)) > 7900
    outcome = simulated(case, options=ClockOptions(fixed_latency=8_000_000))
    assert max(map(abs, outcome.within(10))) < 150
