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
        """Change what is settled."""
        self._state = replace(SETTLED, **changes)

    def state(self):
        """Return the state."""
        return self._state


def made(clock):
    """Return the task for a clock whose data flows."""
    return TimeTask(clock, lambda now: False)


@pytest.mark.parametrize('changes, level, words', [
    ({}, OK, 'Stamps are device time'),
    ({'source': 'arrival', 'in_use': 'arrival', 'settled': False}, OK, 'as time.source says'),
    ({'settled': False, 'in_use': 'arrival', 'held': 3}, WARN, 'samples wait'),
    ({'settled': False, 'in_use': 'arrival'}, WARN, 'stamps are arrival times'),
    ({'source': 'sync_pulse'}, WARN, 'No sync pulses'),
    ({'source': 'sync_pulse', 'in_use': 'sync_pulse'}, OK, 'Stamps are device time'),
])
def test_levels(changes, level, words):
    """What is in use, and whether that is what was asked for."""
    summary = summary_of(made(Fixed(**changes)), 100.0)
    assert summary.level == level and words in summary.message


def test_a_notice_is_shown_for_five_seconds():
    """So that it is seen by who looks once a second."""
    task = made(Fixed())
    task.notice("the host's clock was set by +0.500000 s", 100.0)
    assert summary_of(task, 104.0) == (WARN, "the host's clock was set by +0.500000 s")
    assert summary_of(task, 106.0).level == OK


def test_values():
    """With units; and what to do about an adapter that holds back."""
    values = values_of(made(Fixed(median_chunk=496, pulse_delay_us=50.37)), 0.0)
    assert values['Time messages name'] == 'the next sample'
    assert values['Least delay by pulses [us]'] == '50.4'
    assert 'set its timer to 1 ms' in values['Advice']
    assert values_of(made(Fixed(median_chunk=24)), 0.0)['Advice'] == 'none'


def test_values_of_a_device_that_is_asked():
    """Values of a clock without device time."""
    values = values_of(made(Fixed(source='exchange', in_use='exchange', spread_us=431.25)), 0.0)
    assert values['Half a request and its answer, median [us]'] == '431.2'
    assert not {'Skew [ppm]', 'Epochs', 'Sync pulses'} & set(values)


@pytest.mark.parametrize('clock', [ArrivalClock(), SampleClock(ROLES)])
def test_real_clocks_before_the_first_byte(clock):
    """Nothing is known yet, and can be shown."""
    assert values_of(made(clock), 0.0)['ROS time less device time [s]'] == 'unknown'
