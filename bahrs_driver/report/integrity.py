# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find which signals were not safe, for how long, and when."""

from collections.abc import Iterator
from typing import NamedTuple

from bahrs_driver.protocol.batch import Array
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.finding import Finding, GOOD, NOTICE, Severity, time_text, WARNING
from bahrs_driver.report.gather import Recording, Signals
import numpy as np

UNSAFE = (Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE, Integrity.RESERVED)
MAX_NOTICE = 1.0        # s in all, above which it is a warning
MAX_LISTED = 3          # intervals that are listed one by one
MAX_STEP = 0.5          # s between two samples; in a longer gap the state is unknown


class Interval(NamedTuple):
    """An interval in which a signal had one state."""

    begin: float            # s since the first sample
    seconds: float


def integrity_findings(recording: Recording) -> Iterator[Finding]:
    """Yield a finding for the signals that were not safe at the same times."""
    signal_names: dict[tuple[Severity, str], list[str]] = {}
    for signals in (recording.inertial, recording.navigation):
        for index, name in enumerate(signals.names):
            for severity, text in _unsafe_states(signals, index):
                signal_names.setdefault((severity, text), []).append(name.replace('_', ' '))
    for (severity, text), names in signal_names.items():
        yield Finding(severity, f'{_list_signals(names).capitalize()}: {text}.')
    if not signal_names and len(recording.inertial.seconds):
        yield Finding(GOOD, 'All signals are safe throughout.')


def find_intervals(seconds: Array, held: Array, max_step: float = MAX_STEP) -> list[Interval]:
    """
    Return the intervals in which a state was held.

    seconds are the times of samples, and held is True for those with the state. A step in time
    above max_step, in seconds, ends an interval.
    """
    if not held.any():
        return []
    steps = np.diff(seconds)
    continued = held[1:] & held[:-1] & (steps <= max_step)
    period = float(np.median(steps, overwrite_input=True)) if len(steps) else 0.0
    begins = seconds[held & ~np.append(False, continued)]
    ends = seconds[held & ~np.append(continued, False)]
    return [Interval(begin, end - begin + period)
            for begin, end in zip(begins.tolist(), ends.tolist())]


def _unsafe_states(signals: Signals, index: int) -> Iterator[tuple[Severity, str]]:
    """Yield the severity and the times of each state that is not safe."""
    health = signals.health[:, index]
    for state in UNSAFE:
        held = health == state
        if held.all() and len(held):
            yield WARNING, f'{state.words} throughout'
        elif held.any():
            intervals = find_intervals(signals.seconds, held)
            total = sum(interval.seconds for interval in intervals)
            yield (WARNING if total > MAX_NOTICE else NOTICE,
                   f'{state.words} for {_describe(intervals, from_start=bool(held[0]))}')


def _describe(intervals: list[Interval], from_start: bool) -> str:
    """
    Describe intervals, the first of which may begin with the first sample.

    That one is separate: a device has no solution at startup, which must not hide later intervals.
    """
    if not from_start:
        return _list_intervals(intervals)
    startup = f'the first {intervals[0].seconds:.2f} s'
    return startup + (f', later for {_list_intervals(intervals[1:])}' if intervals[1:] else '')


def _list_intervals(intervals: list[Interval]) -> str:
    if len(intervals) <= MAX_LISTED:
        return _join([f'{seconds:.2f} s from {time_text(begin)}'
                      for begin, seconds in intervals])
    total = sum(interval.seconds for interval in intervals)
    longest = max(intervals, key=lambda interval: interval.seconds)
    first, last = intervals[0], intervals[-1]
    return (f'{total:.2f} s in {len(intervals):,} intervals from {time_text(first.begin)} to '
            f'{time_text(last.begin + last.seconds)}, the longest {longest.seconds:.2f} s '
            f'from {time_text(longest.begin)}')


def _list_signals(names: list[str]) -> str:
    """Join names of signals; the three components of a vector are one name."""
    for quantity in ('specific force', 'angular rate'):
        components = [f'{quantity} {axis}' for axis in 'xyz']
        if set(components) <= set(names):
            names = [quantity] + [name for name in names if name not in components]
    return _join(names)


def _join(texts: list[str]) -> str:
    return ', '.join(texts[:-1]) + ' and ' + texts[-1] if len(texts) > 1 else texts[0]
