# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the findings about integrity: no interval hides another one."""

import re
from types import SimpleNamespace

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.finding import GOOD, NOTICE, time_text, WARNING
from bahrs_driver.report.gather import Signals
from bahrs_driver.report.integrity import find_intervals, integrity_findings, MAX_STEP
from hypothesis import given, strategies as st
import numpy as np
import pytest

PERIOD = 0.01
NAMES = ('pressure_height', 'roll')
NOTHING = Signals(np.empty(0), {}, np.empty((0, 0), np.uint8), ())


def sentences(health, seconds=None, names=NAMES):
    """Return the findings about navigation signals, one column of health for each."""
    seconds = PERIOD * np.arange(len(health)) if seconds is None else seconds
    signals = Signals(seconds, {}, np.asarray(health, np.uint8), names)
    return list(integrity_findings(SimpleNamespace(inertial=NOTHING, navigation=signals)))


def unavailable(count, *parts):
    """Return the health of one signal, unavailable in the parts from begin to before end."""
    health = np.full((count, 1), Integrity.SAFE, np.uint8)
    for begin, end in parts:
        health[begin:end] = Integrity.UNAVAILABLE
    return health


@pytest.mark.parametrize(('parts', 'level', 'text'), [
    ([(0, 8)], NOTICE, 'unavailable for the first 0.08 s'),
    ([(0, 8), (6000, 12000), (19_000, 19_008)], WARNING,
     'unavailable for the first 0.08 s, later for 60.00 s from 1:00.0 and 0.08 s from 3:10.0'),
    ([(500, 800)], WARNING, 'unavailable for 3.00 s from 0:05.0'),
    ([(0, 20_000)], WARNING, 'unavailable throughout'),
    ([(0, 8), *((begin, begin + 5) for begin in range(1000, 9000, 1000)), (12_000, 18_000)],
     WARNING, 'unavailable for the first 0.08 s, later for 60.40 s in 9 intervals from 0:10.0 to '
              '3:00.0, the longest 60.00 s from 2:00.0'),
    ([(19_999, 20_000)], NOTICE, 'unavailable for 0.01 s from 3:20.0'),
])
def test_startup_is_separate(parts, level, text):
    """The interval at startup is listed first, then those after it with their times."""
    assert sentences(unavailable(20_000, *parts), names=('roll',)) == [(level, f'Roll: {text}.')]


def test_signals_with_the_same_intervals():
    """They share a sentence; each state of a signal has one of its own."""
    health = np.repeat(unavailable(3000, (1000, 1500)), 2, axis=1)
    health[2000:2010, 1] = Integrity.INTEGRITY_RISK
    assert [text for _, text in sentences(health)] == [
        'Pressure height and roll: unavailable for 5.00 s from 0:10.0.',
        'Roll: integrity risk for 0.10 s from 0:20.0.']


def test_gap_ends_an_interval():
    """The state of a signal is unknown while no sample arrives."""
    seconds = PERIOD * np.arange(1000)
    seconds[600:] += 30.0
    found = find_intervals(seconds, np.isin(np.arange(1000), range(500, 700)))
    assert [(round(begin, 6), round(length, 6)) for begin, length in found] == [
        (5.0, 1.0), (36.0, 1.0)]


def test_all_signals_safe():
    """One finding reports that all signals are safe."""
    recording = SimpleNamespace(
        inertial=Signals(PERIOD * np.arange(9), {}, unavailable(9), ('force',)),
        navigation=NOTHING)
    assert list(integrity_findings(recording)) == [(GOOD, 'All signals are safe throughout.')]


@given(lengths=st.lists(st.integers(1, 3000), min_size=1, max_size=12), first=st.booleans(),
       pauses=st.lists(st.floats(0.0, 100.0), min_size=12, max_size=12))
def test_no_interval_is_hidden(lengths, first, pauses):
    """The finding has the interval at startup and the longest one after it, with their times."""
    held = np.repeat([(index % 2 == 0) == first for index in range(len(lengths))], lengths)
    steps = np.full(len(held), PERIOD)
    for index, pause in zip(np.cumsum([0, *lengths[:-1]]), pauses):
        steps[index] += pause
    seconds = np.cumsum(steps) - steps[0]
    health = np.where(held, Integrity.UNAVAILABLE, Integrity.SAFE)[:, None]
    text = ''.join(text for _, text in sentences(health, seconds, ('roll',)))
    found = find_intervals(seconds, held)
    assert sum(interval.seconds for interval in found) == pytest.approx(
        held.sum() * float(np.median(np.diff(seconds))) if len(held) > 1 else 0.0, abs=0.1)
    if not found or held.all():
        assert text in ('', 'Roll: unavailable throughout.')
        return
    if first:
        startup, found = found[0], found[1:]
        assert f'for the first {startup.seconds:.2f} s' in text
    if found:
        longest = max(found, key=lambda interval: interval.seconds)
        assert f'{longest.seconds:.2f} s from {time_text(longest.begin)}' in text
    assert MAX_STEP > PERIOD


@given(st.floats(0.0, 1e6))
def test_time_text(seconds):
    """No minute has 60 seconds, and no tenth is lost."""
    hours, minutes, rest = re.fullmatch(
        r'(?:(\d+):)?(\d+):(\d\d\.\d)', time_text(seconds)).groups()
    assert float(rest) < 60.0 and (hours is None or int(minutes) < 60)
    assert int(hours or 0) * 3600 + int(minutes) * 60 + float(rest) == pytest.approx(
        seconds, abs=0.051)
