# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the times of all inertial samples of a recording, from counters and time messages.

Time messages are anchors: each gives the device time of one sample, and the samples between two
anchors are counted by their sequence counters. If the device time and the count between two
anchors differ, whole turns of the counter were lost, the device paused, or it restarted.
"""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from bahrs_driver.protocol.batch import Array, Columns
from bahrs_driver.units import COUNTER_MODULUS, S_PER_US
import numpy as np

TOLERANCE = 0.5             # of a period, by which an anchor may be off
MAX_CLOCK_ERROR = 0.03      # relative difference between measured and nominal period
UNKNOWN_PAUSE = 1.0         # s assumed for the unknown time for which a device was off


class BreakKind(Enum):
    """Why samples are not consecutive."""

    LOST = 'lost'
    PAUSED = 'paused'
    RESTARTED = 'restarted'


@dataclass(frozen=True)
class Break:
    """A place where samples are not consecutive."""

    index: int              # of the first sample after it
    kind: BreakKind
    missing: int            # samples lost, by the counters; 0 for other kinds
    seconds: float          # from the sample before to the one after; assumed for a restart


@dataclass(frozen=True)
class TimeAxis:
    """The times of the samples."""

    seconds: Array          # of each inertial sample, since the first, on the device's clock
    device_us: Array        # device time of each, NaN where there is none
    label_ahead: int | None         # samples by which time messages are ahead: 1 is 'next'
    period: float | None            # s from one sample to the next on the device's clock
    breaks: list[Break]             # in order
    anchors: int                    # time messages that were used
    rejected: int                   # time messages that contradicted the others


class _Anchors(NamedTuple):
    """Columns with one element per time message."""

    latest: Array           # index of the latest sample before the message
    counts: Array           # count of the sample that the message refers to
    seconds: Array          # device time of that sample

    def select(self, mask: Array) -> '_Anchors':
        return _Anchors(*(column[mask] for column in self))


def make_time_axis(offset: Array, sequence: Array, times: Columns,
                   nominal_period: float) -> TimeAxis:
    """
    Compute the times of samples, whose nominal period is in seconds.

    offset and sequence, uint8, are those of the inertial messages, times the columns of the
    inertial time messages.
    """
    if not len(offset):
        return TimeAxis(np.empty(0), np.empty(0), None, None, [], 0, 0)
    steps = np.diff(sequence)           # the counters and their differences are modulo 256
    counts = np.zeros(len(offset), np.int64)
    np.cumsum(steps, out=counts[1:])
    anchors, ahead = _anchors(offset, sequence, counts, times)
    period = _measure_period(anchors, nominal_period)
    outlier = _outliers(anchors, period)
    anchors = anchors.select(~outlier)
    breaks = _breaks_between_anchors(steps, anchors, period)
    seconds, device_us = _interpolate(counts, steps, anchors, breaks, period)
    return TimeAxis(seconds, device_us, ahead, period if len(anchors.counts) > 1 else None,
                    sorted([*breaks, *_counter_gaps(steps, breaks, period)],
                           key=lambda found: found.index),
                    len(anchors.counts), int(outlier.sum()))


def _anchors(offset: Array, sequence: Array, counts: Array,
             times: Columns) -> tuple[_Anchors, int | None]:
    """Return the anchors, and by how many samples time messages are ahead."""
    latest = np.searchsorted(offset, times['offset']) - 1
    usable = ((times['reference_sequence'] != 0) | (times['device_time_us'] != 0)) & (latest >= 0)
    latest, seconds = latest[usable], times['device_time_us'][usable] * S_PER_US
    if not len(latest):
        return _Anchors(latest, latest, seconds), None
    half = COUNTER_MODULUS // 2
    ahead = (times['reference_sequence'][usable].astype(np.int64) - sequence[latest] + half) \
        % COUNTER_MODULUS - half
    usual = int(np.median(ahead))
    return _Anchors(latest, counts[latest] + ahead - (usual == 1), seconds), usual


def _measure_period(anchors: _Anchors, nominal: float) -> float:
    """Return the median period between anchors in s; the nominal one if there is none."""
    counted, elapsed = np.diff(anchors.counts), np.diff(anchors.seconds)
    forward = (counted > 0) & (elapsed > 0)
    periods = elapsed[forward] / counted[forward]
    periods = periods[abs(periods / nominal - 1) < MAX_CLOCK_ERROR]
    return float(np.median(periods)) if len(periods) else nominal


def _outliers(anchors: _Anchors, period: float) -> Array:
    """Return which anchors contradict both neighbours although these agree with each other."""
    outlier = np.zeros(len(anchors.counts), bool)
    if len(outlier) > 2:
        start = anchors.seconds - anchors.counts * period    # device time of count 0
        jump = abs(np.diff(start)) > TOLERANCE * period
        outlier[1:-1] = jump[:-1] & jump[1:] & (
            abs(start[2:] - start[:-2]) < 2 * TOLERANCE * period)
    return outlier


def _breaks_between_anchors(steps: Array, anchors: _Anchors, period: float) -> list[Break]:
    """Return the breaks that only time messages show."""
    breaks: list[Break] = []
    if not len(steps):
        return breaks
    excess = np.diff(anchors.seconds - anchors.counts * period)
    for number in np.flatnonzero(abs(excess) > TOLERANCE * period):
        before, after = anchors.latest[number:number + 2]
        # Where the counter is not consecutive either, or else just before the later anchor.
        gaps = np.flatnonzero(steps[before:after] != 1)
        index = int(before + 1 + gaps[0]) if len(gaps) else max(1, int(after))
        step = int(steps[index - 1])
        turns, rest = divmod(float(excess[number]) / period + TOLERANCE, COUNTER_MODULUS)
        seconds = float(excess[number]) + step * period
        if anchors.seconds[number + 1] < anchors.seconds[number]:
            breaks.append(Break(index, BreakKind.RESTARTED, 0, UNKNOWN_PAUSE))
        elif turns > 0 and rest < 2 * TOLERANCE:
            breaks.append(Break(index, BreakKind.LOST,
                                int(turns) * COUNTER_MODULUS + step - 1, seconds))
        else:
            breaks.append(Break(index, BreakKind.PAUSED, 0, seconds))
    return breaks


def _counter_gaps(steps: Array, breaks: list[Break], period: float) -> list[Break]:
    """Return the other gaps, those that the counters alone explain."""
    explained = {found.index for found in breaks}
    return [Break(int(index) + 1, BreakKind.LOST, int(steps[index]) - 1,
                  float(steps[index]) * period)
            for index in np.flatnonzero(steps > 1) if int(index) + 1 not in explained]


def _interpolate(counts: Array, steps: Array, anchors: _Anchors, breaks: list[Break],
                 period: float) -> tuple[Array, Array]:
    """Return the time of each sample since the first in s, and its device time in us."""
    # There may be millions of samples: arrays are changed in place.
    seconds = counts * period
    if breaks:
        pauses = np.zeros(len(counts))  # s before each sample that its count does not explain
        for found in breaks:
            pauses[found.index] = found.seconds - steps[found.index - 1] * period
        seconds += np.cumsum(pauses, out=pauses)
    device_us = np.full(len(counts), np.nan)
    edges = [0, *sorted(found.index for found in breaks), len(counts)]
    for begin, end in zip(edges, edges[1:]):
        latest, known, time = anchors.select((anchors.latest >= begin) & (anchors.latest < end))
        if len(latest):
            # The clock's error is interpolated between anchors, and constant outside of them.
            here = counts[begin:end]
            device = np.interp(here, known, time - known * period)
            device += here * period
            np.divide(device, S_PER_US, out=device_us[begin:end])
            first = device[0]
            device += seconds[begin]
            np.subtract(device, first, out=seconds[begin:end])
    seconds -= seconds[0]
    return seconds, device_us
