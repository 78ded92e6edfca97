# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find which signals were not safe, for how long, and when."""

from collections.abc import Iterator
from typing import NamedTuple

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.finding import clock_time, Finding, GOOD, NOTICE, Severity, WARNING
from bahrs_driver.report.gather import Recording, Signals
from bahrs_driver.report.time_axis import Array
import numpy as np

UNSAFE = (Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE, Integrity.RESERVED)
MUCH = 1.0              # s in all, above which it is a warning
NAMED = 3               # intervals that are named one by one
GAP = 0.5               # s without a sample, in which the state is unknown


class Interval(NamedTuple):
    """A time, in seconds since the first sample, over which a signal had one state."""

    begin: float
    seconds: float


def integrity_findings(recording: Recording) -> Iterator[Finding]:
    """Yield the signals that were not safe, in one finding for those with the same times."""
    alike: dict[tuple[Severity, str], list[str]] = {}
    for signals in (recording.inertial, recording.navigation):
        for index, name in enumerate(signals.names):
            for level, text in _signal(signals, index):
                alike.setdefault((level, text), []).append(name.replace('_', ' '))
    for (level, text), names in alike.items():
        yield Finding(level, f'{_listed(names).capitalize()}: {text}.')
    if not alike and len(recording.inertial.seconds):
        yield Finding(GOOD, 'All signals are safe throughout.')


def find_intervals(seconds: Array, held: Array) -> list[Interval]:
    """Return the intervals of a state, from the times of samples and whether each has it."""
    where = np.flatnonzero(held)
    if not len(where):
        return []
    steps = np.diff(seconds)
    period = float(np.median(steps)) if len(steps) else 0.0
    breaks = np.flatnonzero((np.diff(where) > 1) | (np.diff(seconds[where]) > GAP)) + 1
    pieces = [seconds[piece] for piece in np.split(where, breaks)]
    return [Interval(float(piece[0]), float(piece[-1] - piece[0]) + period) for piece in pieces]


def _signal(signals: Signals, index: int) -> Iterator[tuple[Severity, str]]:
    """Yield the severity and the times of each state that is not safe."""
    health = signals.health[:, index]
    for state in UNSAFE:
        held = health == state
        if held.all() and len(held):
            yield WARNING, f'{state.words} throughout'
        elif held.any():
            found = find_intervals(signals.seconds, held)
            total = sum(interval.seconds for interval in found)
            yield (WARNING if total > MUCH else NOTICE,
                   f'{state.words} for {_when(found, from_start=bool(held[0]))}')


def _when(found: list[Interval], from_start: bool) -> str:
    """
    Return when a signal had a state.

    The interval from the first sample on is separate: a device has no solution at startup, which
    must not hide later intervals.
    """
    if not from_start:
        return _listed_times(found)
    startup = f'the first {found[0].seconds:.2f} s'
    return startup + (f', later for {_listed_times(found[1:])}' if found[1:] else '')


def _listed_times(found: list[Interval]) -> str:
    if len(found) <= NAMED:
        return _joined([f'{seconds:.2f} s from {clock_time(begin)}' for begin, seconds in found])
    total = sum(interval.seconds for interval in found)
    longest = max(found, key=lambda interval: interval.seconds)
    return (f'{total:.2f} s in {len(found):,} intervals from {clock_time(found[0].begin)} to '
            f'{clock_time(found[-1].begin + found[-1].seconds)}, the longest '
            f'{longest.seconds:.2f} s from {clock_time(longest.begin)}')


def _listed(names: list[str]) -> str:
    """Return names as a text; the components of a vector are one name."""
    for quantity in ('specific force', 'angular rate'):
        components = [f'{quantity} {axis}' for axis in 'xyz']
        if set(components) <= set(names):
            names = [quantity] + [name for name in names if name not in components]
    return _joined(names)


def _joined(texts: list[str]) -> str:
    return ', '.join(texts[:-1]) + ' and ' + texts[-1] if len(texts) > 1 else texts[0]
