# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of sync pulses, with literal pairs."""

from bahrs_driver.clock import Instant
from bahrs_driver.clock.estimation.pulses import DelayEstimate, PulseReference, PulseTracker
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.clock.host import HostClocks
from bahrs_driver.clock.sync_pulses import SyncPulses
import pytest

S = 1_000_000_000
OFFSET = 7 * S + 123


def fed(*pulses, tracker=None):
    """Return a tracker after some pulses: second, and error of the host time in us."""
    tracker = tracker or PulseTracker(S)
    for second, error in pulses:
        tracker.feed(second * S, second * S + OFFSET + error * 1000, 0.0, 20e-6)
    return tracker


def test_the_tracker_settles_after_three_pulses():
    """Exact pulses give an exact estimate."""
    tracker = fed((1, 0), (2, 0))
    assert not tracker.settled
    fed((3, 0), tracker=tracker)
    assert tracker.settled and tracker.host_time(4 * S) == 4 * S + OFFSET


def test_a_spurious_pulse_is_counted_and_has_no_effect():
    """Interference on a wire may look like a pulse."""
    tracker = fed((1, 0), (2, 0), (3, 0), (4, 5000), (5, 0))
    assert (tracker.accepted, tracker.spurious, tracker.missing) == (4, 1, 0)
    assert tracker.host_time(6 * S) == pytest.approx(6 * S + OFFSET, abs=100)


def test_missing_pulses_are_counted():
    """Three pulses are missing between 3 s and 7 s."""
    tracker = fed((1, 0), (2, 0), (3, 0), (7, 0))
    assert tracker.missing == 3 and tracker.settled


def test_four_misses_in_a_row_restart_the_tracker():
    """The cable may be disconnected."""
    tracker = fed((1, 0), (2, 0), (3, 0))
    tracker.check_timeout(7 * S)
    assert tracker.settled and tracker.missing == 0
    for second in (8, 9):
        tracker.check_timeout(second * S)
        assert not tracker.settled and tracker.missing == 4


def test_four_misfits_in_a_row_are_accepted():
    """The host's clock may have been set."""
    tracker = fed((1, 0), (2, 0), (3, 0), *((second, 300_000) for second in range(4, 10)))
    assert tracker.settled
    assert tracker.host_time(10 * S) == pytest.approx(10 * S + OFFSET + 300_000_000, abs=1000)


@pytest.mark.parametrize('about, expected', [
    (10 * S + 16_000_000, 10 * S), (10 * S - 400_000_000, 10 * S), (10 * S, 10 * S)])
def test_the_nearest_whole_second(about, expected):
    """A host disciplined by the same receiver needs no external times."""
    assert PulseReference(S, external=False).find(about) == expected


def test_external_times():
    """The nearest one within half a period is used."""
    reference = PulseReference(S, external=True)
    assert reference.find(5 * S) is None
    reference.add(4 * S + 250_000_000)
    reference.add(5 * S + 250_000_000)
    assert reference.find(5 * S + 260_000_000) == 5 * S + 250_000_000
    assert reference.find(9 * S) is None


def test_the_delay_is_a_median():
    """A single outlier does not affect it."""
    delay = DelayEstimate()
    assert delay.value is None
    for value in (50, 52, 9_000_000, 51, 49):
        delay.add(value)
    assert delay.value == 51


def test_a_pulse_that_contradicts_the_bounds_is_rejected():
    """Samples would be later than their reads: the host's clock is not that of the pulses."""
    passive, host, pulses = Tracker(), HostClocks(), SyncPulses(True, S, False)
    host.observe_read(Instant(0, 0))
    for second in range(1, 6):
        passive.feed(second * S, second * S + 50_000)
        pulses.add(second * S - 300_000_000)
        pulses.update(second * S, passive, host)
    assert pulses.active_tracker is None
    assert (pulses.tracker.accepted, pulses.tracker.spurious) == (0, 5)
