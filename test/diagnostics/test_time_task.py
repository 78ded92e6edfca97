# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the task Time."""

from dataclasses import replace

from bahrs_driver.clock import ArrivalClock, SampleClock, TimeState
from bahrs_driver.diagnostics.task import OK, WARN
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.protocol.bahrs.roles import ROLES
import pytest
from support.tasks import summary_of, values_of

SETTLED = TimeState('device', 'device', 'next', settled=True, offset_ns=10 ** 18)


class Fixed:
    """A clock in a given state."""

    def __init__(self, **changes):
        """Change some fields of a settled state."""
        self._state = replace(SETTLED, **changes)

    def state(self):
        """Return the state."""
        return self._state


def make_task(clock):
    """Return the task for a clock with a stream that is not stale."""
    return TimeTask(clock, lambda now: False)


@pytest.mark.parametrize('changes, level, words', [
    ({}, OK, 'Stamps are device time'),
    ({'source': 'arrival', 'in_use': 'arrival', 'settled': False}, OK, 'as time.source says'),
    ({'settled': False, 'in_use': 'arrival', 'held': 3}, WARN, 'samples wait'),
    ({'settled': False, 'in_use': 'arrival'}, WARN, 'stamps are arrival times'),
    ({'source': 'sync_pulse'}, WARN, 'No sync pulses'),
    ({'source': 'sync_pulse', 'in_use': 'sync_pulse'}, OK, 'Stamps are device time'),
])
def test_levels_and_messages(changes, level, words):
    """They depend on the source in use and on the requested source."""
    summary = summary_of(make_task(Fixed(**changes)), 100.0)
    assert summary.level == level and words in summary.message


def test_an_event_is_shown_for_five_seconds():
    """A user who looks once a second sees it."""
    task = make_task(Fixed())
    task.notice("the host's clock was set by +0.500000 s", 100.0)
    assert summary_of(task, 104.0) == (WARN, "the host's clock was set by +0.500000 s")
    assert summary_of(task, 106.0).level == OK


def test_values():
    """They have units, and advice on an adapter that holds bytes back."""
    values = values_of(make_task(Fixed(median_chunk=496, pulse_delay_us=50.37)), 0.0)
    assert values['Time messages name'] == 'the next sample'
    assert values['Least delay by pulses [us]'] == '50.4'
    assert 'set its timer to 1 ms' in values['Advice']
    assert values_of(make_task(Fixed(median_chunk=24)), 0.0)['Advice'] == 'none'


def test_values_of_a_polled_device():
    """It has no device time."""
    clock = Fixed(source='exchange', in_use='exchange', spread_us=431.25)
    values = values_of(make_task(clock), 0.0)
    assert values['Half a request and its answer, median [us]'] == '431.2'
    assert not {'Skew [ppm]', 'Epochs', 'Sync pulses'} & set(values)


@pytest.mark.parametrize('clock', [ArrivalClock(), SampleClock(ROLES)])
def test_values_before_the_first_byte(clock):
    """They are unknown."""
    assert values_of(make_task(clock), 0.0)['ROS time less device time [s]'] == 'unknown'
