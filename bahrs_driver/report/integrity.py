# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Findings about integrity: which signals were not safe, for how long, and when."""

from collections.abc import Iterator
from typing import NamedTuple

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.finding import clock_time, Finding, GOOD, NOTICE, WARNING
from bahrs_driver.report.gather import Recording, Signals
from bahrs_driver.report.timeline import Array
import numpy as np

WORDS = {Integrity.INTEGRITY_RISK: 'at integrity risk', Integrity.UNAVAILABLE: 'unavailable',
         Integrity.RESERVED: 'reserved'}
MUCH = 1.0              # s in all, above which it is a warning
NAMED = 3               # stretches that are named one by one
GAP = 0.5               # s without a sample that end a stretch: nothing is known of them


class Stretch(NamedTuple):
    """A time, in seconds since the first sample, over which a signal had one state."""

    begin: float
    seconds: float


def integrity_findings(recording: Recording) -> Iterator[Finding]:
    """Yield which signals were not safe; those that were so at the same times together."""
    alike: dict[tuple[str, str], list[str]] = {}
    for signals in (recording.inertial, recording.navigation):
        for index, name in enumerate(signals.names):
            for level, text in _signal(signals, index):
                alike.setdefault((level, text), []).append(name.replace('_', ' '))
    for (level, text), names in alike.items():
        yield Finding(level, f'{_listed(names).capitalize()}: {text}.')
    if not alike and len(recording.inertial.seconds):
        yield Finding(GOOD, 'All signals are safe throughout.')


def stretches(seconds: Array, held: Array) -> list[Stretch]:
    """Return when samples held a state, by their times and whether each did."""
    where = np.flatnonzero(held)
    if not len(where):
        return []
    steps = np.diff(seconds)
    period = float(np.median(steps)) if len(steps) else 0.0
    breaks = np.flatnonzero((np.diff(where) > 1) | (np.diff(seconds[where]) > GAP)) + 1
    pieces = [seconds[piece] for piece in np.split(where, breaks)]
    return [Stretch(float(piece[0]), float(piece[-1] - piece[0]) + period) for piece in pieces]


def _signal(signals: Signals, index: int) -> Iterator[tuple[str, str]]:
    """Yield how much it matters that a signal was not safe, and when that was."""
    health = signals.health[:, index]
    for state, words in WORDS.items():
        held = health == state
        if held.all() and len(held):
            yield WARNING, f'{words} throughout'
        elif held.any():
            found = stretches(signals.seconds, held)
            total = sum(stretch.seconds for stretch in found)
            yield (WARNING if total > MUCH else NOTICE,
                   f'{words} for {_when(found, from_start=bool(held[0]))}')


def _when(found: list[Stretch], from_start: bool) -> str:
    """
    Return when a signal had a state.

    The time from the first sample on is named for itself: a device has no solution at startup,
    and that must not hide what happens later.
    """
    if not from_start:
        return _listed_times(found)
    startup = f'the first {found[0].seconds:.2f} s'
    return startup + (f', later for {_listed_times(found[1:])}' if found[1:] else '')


def _listed_times(found: list[Stretch]) -> str:
    if len(found) <= NAMED:
        return _joined([f'{seconds:.2f} s from {clock_time(begin)}' for begin, seconds in found])
    total = sum(stretch.seconds for stretch in found)
    longest = max(found, key=lambda stretch: stretch.seconds)
    return (f'{total:.2f} s in {len(found):,} stretches from {clock_time(found[0].begin)} to '
            f'{clock_time(found[-1].begin + found[-1].seconds)}, the longest '
            f'{longest.seconds:.2f} s from {clock_time(longest.begin)}')


def _listed(names: list[str]) -> str:
    """Return names as a text, those of a whole vector together."""
    for quantity in ('specific force', 'angular rate'):
        components = [f'{quantity} {axis}' for axis in 'xyz']
        if set(components) <= set(names):
            names = [quantity] + [name for name in names if name not in components]
    return _joined(names)


def _joined(texts: list[str]) -> str:
    return ', '.join(texts[:-1]) + ' and ' + texts[-1] if len(texts) > 1 else texts[0]
