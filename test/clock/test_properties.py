# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Properties of the clock that hold for any input."""

from bahrs_driver.clock import ClockOptions, Instant, SampleClock
from bahrs_driver.clock.stamp_queue import MESSAGES_PER_SAMPLE
from bahrs_driver.protocol.bahrs.messages import (
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    SyncPulseTime,
)
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Frame
from clock_simulation import Case
from hypothesis import given, settings, strategies as st
import pytest
from support.simulated import simulated

FAULTS_END = 8.0
MOST_WAITING = MESSAGES_PER_SAMPLE * ClockOptions().most_held
counters = st.integers(0, 255)
times = st.one_of(st.integers(0, 2 ** 64 - 1), st.integers(0, 10 ** 7))
messages = st.one_of(
    st.builds(Inertial, counters, st.just(()), st.just(()), st.just(())),
    st.builds(Navigation, counters, *[st.just(0.0)] * 5, st.just(())),
    st.builds(InertialTime, counters, counters, times),
    st.builds(NavigationTime, counters, counters, times),
    st.builds(SyncPulseTime, counters, times),
    st.just(object()))
reads = st.tuples(st.integers(0, 3 * 10 ** 9), st.integers(-10 ** 9, 10 ** 9),
                  st.lists(messages, max_size=20))


@settings(max_examples=300)
@given(st.lists(reads, max_size=40))
def test_any_input_is_stamped_in_order(all_reads):
    """Any messages at any times, on a host whose clock is set at random."""
    clock = SampleClock(ROLES)
    clock.begin(86_805)
    raw, ros, received = 10 ** 9, 10 ** 18, 0
    for elapsed, jump, batch in all_reads:
        raw, ros = raw + elapsed, ros + elapsed + (jump if elapsed % 7 == 0 else 0)
        frames = [Frame(received + 28 * index, bytes(28), 'word') for index in range(len(batch))]
        received += 28 * len(batch)
        clock.observe_read(Instant(raw, ros), received)
        stamped = clock.stamp(list(zip(batch, frames)))
        samples = [item.stamp_ns for item in stamped if isinstance(item.message, Inertial)]
        assert samples == sorted(set(samples))
        assert clock.state().held <= MOST_WAITING


def test_navigation_messages_without_samples_have_arrival_stamps():
    """They do not wait forever for a sample."""
    clock, stamped = SampleClock(ROLES), []
    clock.begin(0)
    for index in range(1000):
        now = Instant(10 ** 9 + index * 10 ** 7, 10 ** 18 + index * 10 ** 7)
        clock.observe_read(now, 24 * (index + 1))
        stamped += clock.stamp([(Navigation(index % 256, *[0.0] * 5, ()),
                                 Frame(24 * index, bytes(24), 'word'))])
    assert [item.stamp_ns for item in stamped] == [
        10 ** 18 + index * 10 ** 7 for index in range(1000)]


rates = st.sampled_from([0.0, 0.003, 0.01])


@pytest.mark.slow
@settings(max_examples=40)
@given(seed=st.integers(0, 10 ** 6), adapter=st.sampled_from([0.016, 0.001, 'packets', 'plain']),
       drift=st.floats(-200, 200), label=st.sampled_from([0, 1]), loss=rates, bad_counters=rates,
       bad_times=rates, duplicates=rates, swaps=rates)
def test_the_effect_of_faults_is_bounded_and_ends(seed, adapter, drift, label, **faults):
    """An error is at most the time of the lost samples, and small after the faults."""
    outcome = simulated(Case(15.0, adapter, drift_ppm=drift, label=label,
                             faults_until=FAULTS_END, **faults), seed)
    assert outcome.backward == outcome.future == 0
    assert min(outcome.within(2, FAULTS_END)) > -20_000
    assert max(outcome.within(2, FAULTS_END)) < 20_000
    assert max(map(abs, outcome.within(FAULTS_END + 2))) < 500
