# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the reference, timeline and verdict of time messages, with literal numbers."""

from bahrs_driver.clock.device_time import DeviceTime, Verdict
from bahrs_driver.clock.time_reference import TimeReferenceConvention
from bahrs_driver.clock.timeline import Timeline
from bahrs_driver.protocol.bahrs.roles import ROLES
import pytest

PERIOD = ROLES.sample_period
START = 600_000_000


@pytest.mark.parametrize('votes, expected', [
    ([], 'not seen yet'), ([1], 'next'), ([0], 'same'), ([1, 0, 1], 'next'), ([0, 1, 0], 'same'),
    ([7, -3], 'not seen yet'), ([0] * 9 + [1] * 5, 'next')])
def test_label_by_votes(votes, expected):
    """The majority of the latest nine."""
    convention = TimeReferenceConvention()
    for vote in votes:
        convention.vote(vote)
    assert convention.label == expected


def test_a_forced_convention_ignores_votes():
    """The parameter decides."""
    convention = TimeReferenceConvention('same')
    convention.vote(1)
    assert convention.ahead == 0 and convention.label == 'same'


def test_timeline_before_and_after_its_anchor():
    """At the nominal period until there is a slope."""
    line = Timeline(20, START, PERIOD)
    assert [line.time_of(count) for count in (0, 20, 21)] == [
        START - 20 * PERIOD, START, START + PERIOD]


def test_timeline_takes_the_period_from_the_slope():
    """Half a percent too long; the next message must fit it rather than the nominal period."""
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


def device(samples=1):
    """Return device time after some samples."""
    made = DeviceTime(ROLES, 'same')
    for index in range(samples):
        made.counter.add(index, index * PERIOD, None)
    return made


def verdicts(made, *messages):
    """Return the verdict on each time message: count, time, lateness."""
    return [made.add_time(*message) for message in messages]


KNOWN, NEW, DOUBTED = Verdict.KNOWN, Verdict.NEW_EPOCH, Verdict.DOUBTED


def test_two_that_agree_begin_the_first_epoch():
    """A single one may be wrong."""
    made = device()
    assert verdicts(made, (0, START, None), (20, START + 20 * PERIOD, None)) == [DOUBTED, NEW]
    assert made.known and made.time_of(40) == START + 40 * PERIOD


def test_one_wrong_message_is_outvoted():
    """By the next one; device time is not known in between."""
    made = device()
    verdicts(made, (0, START, None), (20, START + 20 * PERIOD, None))
    assert verdicts(made, (40, 77_000_000_000, -10 ** 10)) == [DOUBTED]
    assert not made.known
    assert verdicts(made, (60, START + 60 * PERIOD, 0)) == [KNOWN]
    assert made.known and made.rejected == 1


def test_two_that_contradict_and_agree_are_a_restart():
    """Device time is near zero again."""
    made = device()
    late = 3600 * 10 ** 9
    verdicts(made, (0, late, None), (20, late + 20 * PERIOD, None))
    assert verdicts(made, (40, START, late), (60, START + 20 * PERIOD, late)) == [DOUBTED, NEW]
    assert made.time_of(60) == START + 20 * PERIOD


def test_two_after_lost_counts_are_no_new_epoch():
    """The host's clock confirms their time."""
    made = device()
    verdicts(made, (0, START, None), (20, START + 20 * PERIOD, None))
    assert verdicts(made, (40, START + 296 * PERIOD, 50_000),
                    (60, START + 316 * PERIOD, 50_000)) == [DOUBTED, KNOWN]


def test_after_silence_one_is_enough_if_the_hosts_clock_agrees():
    """The device was unplugged, and not switched off."""
    made = device()
    verdicts(made, (0, START, None), (20, START + 20 * PERIOD, None))
    made.jump_count(100, 10 ** 10)
    assert not made.known
    count = made.counter.count
    assert verdicts(made, (count, START + 2000 * PERIOD, 90_000)) == [KNOWN]
    assert made.time_of(count + 1) == START + 2001 * PERIOD


def test_navigation_goes_with_the_inertial_sample_of_its_time():
    """Also after the counter wrapped."""
    made = device(5)
    made.pair(2)
    assert made.navigation.count(2, made.counter.latest) == 4
    made.counter.add(5, 5 * PERIOD, None)
    assert made.count_for_navigation_time(3) == 6
