# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the convention, timeline and trust of time messages, with literal numbers."""

from bahrs_driver.clock.device_time import DeviceTime
from bahrs_driver.clock.time_reference import TimeReferenceConvention
from bahrs_driver.clock.timeline import Timeline
from bahrs_driver.protocol.bahrs.roles import ROLES
import pytest

PERIOD = ROLES.sample_period
START = 600_000_000


@pytest.mark.parametrize('votes, expected', [
    ([], 'not seen yet'), ([1], 'next'), ([0], 'same'), ([1, 0, 1], 'next'), ([0, 1, 0], 'same'),
    ([7, -3], 'not seen yet'), ([0] * 9 + [1] * 5, 'next')])
def test_votes_decide_the_convention(votes, expected):
    """The majority of the latest nine votes decides."""
    convention = TimeReferenceConvention()
    for vote in votes:
        convention.vote(vote)
    assert convention.label == expected


def test_a_forced_convention_ignores_votes():
    """The parameter forces it."""
    convention = TimeReferenceConvention('same')
    convention.vote(1)
    assert convention.ahead == 0 and convention.label == 'same'


def test_timeline_before_and_after_its_anchor():
    """Until there is a slope, the period is nominal."""
    line = Timeline(20, START, PERIOD)
    assert [line.time_of(count) for count in (0, 20, 21)] == [
        START - 20 * PERIOD, START, START + PERIOD]


def test_timeline_takes_the_period_from_the_slope():
    """It is half a percent longer than nominal, and later messages must fit it."""
    line = Timeline(0, 0, PERIOD)
    for index in range(1, 4):
        assert line.agrees(20 * index, 100_500_000 * index)
        line.accept(20 * index, 100_500_000 * index)
    assert line.period == 5_025_000
    assert line.time_of(61) == 301_500_000 + 5_025_000
    assert not line.agrees(80, 400_000_000)


def test_timeline_rejects_an_implausible_slope():
    """A device deviates by 3 % from the nominal period at most."""
    assert not Timeline(0, 0, PERIOD).agrees(20, 104_000_000)


KNOWN, NEW_EPOCH, DOUBTED = 'known', 'new epoch', 'doubted'


def device(samples=1):
    """Return device time after some samples."""
    made = DeviceTime(ROLES, 'same')
    for index in range(samples):
        made.counter.add(index, index * PERIOD, None)
    return made


def add(made, *messages):
    """Add time messages (count, time, lateness); return the state after each."""
    states = []
    for message in messages:
        jumped = made.add_time(*message)
        assert made.known or not jumped
        states.append(NEW_EPOCH if jumped else KNOWN if made.known else DOUBTED)
    return states


def test_two_agreeing_messages_begin_the_first_epoch():
    """A single message may be wrong."""
    made = device()
    assert add(made, (0, START, None), (20, START + 20 * PERIOD, None)) == [DOUBTED, NEW_EPOCH]
    assert made.known and made.time_of(40) == START + 40 * PERIOD


def test_the_next_message_outvotes_one_wrong_message():
    """Device time is not known in between."""
    made = device()
    add(made, (0, START, None), (20, START + 20 * PERIOD, None))
    assert add(made, (40, 77_000_000_000, -10 ** 10)) == [DOUBTED]
    assert not made.known
    assert add(made, (60, START + 60 * PERIOD, 0)) == [KNOWN]
    assert made.known and made.rejected == 1


def test_two_agreeing_messages_that_contradict_the_timeline_show_a_restart():
    """Device time is near zero again."""
    made = device()
    late = 3600 * 10 ** 9
    add(made, (0, late, None), (20, late + 20 * PERIOD, None))
    assert add(made, (40, START, late), (60, START + 20 * PERIOD, late)) == [DOUBTED, NEW_EPOCH]
    assert made.time_of(60) == START + 20 * PERIOD


def test_two_agreeing_messages_after_lost_counts_begin_no_epoch():
    """The host's clock confirms their time."""
    made = device()
    add(made, (0, START, None), (20, START + 20 * PERIOD, None))
    assert add(made, (40, START + 296 * PERIOD, 50_000),
               (60, START + 316 * PERIOD, 50_000)) == [DOUBTED, KNOWN]


def test_after_silence_one_message_suffices_if_the_hosts_clock_agrees():
    """The device was unplugged, but not switched off."""
    made = device()
    add(made, (0, START, None), (20, START + 20 * PERIOD, None))
    made.jump_count(100, 10 ** 10)
    assert not made.known
    count = made.counter.count
    assert add(made, (count, START + 2000 * PERIOD, 90_000)) == [KNOWN]
    assert made.time_of(count + 1) == START + 2001 * PERIOD


def test_a_navigation_time_message_names_the_inertial_sample_of_its_navigation_message():
    """Navigation message 2 belongs to sample 4, and 3 to sample 6."""
    made = device(5)
    made.pair(2)
    assert made.navigation.count(2, made.counter.latest) == 4
    made.counter.add(5, 5 * PERIOD, None)
    assert made.count_for_navigation_time(3) == 6
