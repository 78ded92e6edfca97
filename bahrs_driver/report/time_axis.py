# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the times of all inertial samples of a recording, from counters and time messages.

Time messages are anchors: they give the device time of one sample, and the samples in between are
counted. If two anchors contradict the count, samples were lost by whole turns of the counter, the
device paused, or it restarted.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any

from bahrs_driver.units import COUNTER_MODULUS, S_PER_US
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

PERIOD = 0.005              # s, nominal
TOLERANCE = 0.5             # of a period, by which an anchor may be off
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
    seconds: float          # duration; an assumption for a restart


@dataclass(frozen=True)
class TimeAxis:
    """The times of the samples."""

    seconds: Array          # of each inertial sample, since the first, on the device's clock
    device_us: Array        # device time of each, NaN where there is none
    label_ahead: int | None         # samples by which time messages are ahead: 1 is 'next'
    period: float | None            # s from one sample to the next on the device's clock
    breaks: list[Break]
    anchors: int                    # time messages that were used
    rejected: int                   # time messages that contradicted the others


def make_time_axis(offset: Array, sequence: Array, times: Array) -> TimeAxis:
    """
    Return the times of samples.

    offset and sequence are those of the inertial messages, times the inertial time messages.
    """
    if not len(offset):
        return TimeAxis(np.empty(0), np.empty(0), None, None, [], 0, 0)
    steps = np.diff(sequence.astype(np.int64)) % COUNTER_MODULUS
    counts = np.concatenate(([0], np.cumsum(steps)))
    latest, counted, device, ahead = _anchors(offset, sequence, counts, times)
    period = _period(counted, device)
    keep = _consistent(counted, device, period)
    rejected = len(keep) - int(keep.sum())
    latest, counted, device = latest[keep], counted[keep], device[keep]
    extra, breaks = _jumps(steps, latest, counted, device, period)
    return _assemble(counts, steps, latest, counted, device, ahead, period, extra, breaks,
                     rejected)


def _anchors(offset: Array, sequence: Array, counts: Array,
             times: Array) -> tuple[Array, Array, Array, int | None]:
    """Return for each time message the latest sample, its reference count and its time in s."""
    times = times[(times['reference_sequence'] != 0) | (times['device_time_us'] != 0)]
    latest = np.searchsorted(offset, times['offset']) - 1
    times, latest = times[latest >= 0], latest[latest >= 0]
    if not len(times):
        return latest, np.empty(0, np.int64), np.empty(0), None
    half = COUNTER_MODULUS // 2
    named = (times['reference_sequence'].astype(np.int64) - sequence[latest] + half) \
        % COUNTER_MODULUS - half
    ahead = int(np.median(named))
    label = 1 if ahead == 1 else 0
    return latest, counts[latest] + named - label, times['device_time_us'] * S_PER_US, ahead


def _period(counted: Array, device: Array) -> float:
    if len(counted) < 2:
        return PERIOD
    steps, seconds = np.diff(counted), np.diff(device)
    good = (steps > 0) & (seconds > 0)
    periods = seconds[good] / steps[good]
    periods = periods[abs(periods / PERIOD - 1) < 0.03]
    return float(np.median(periods)) if len(periods) else PERIOD


def _consistent(counted: Array, device: Array, period: float) -> Array:
    """Return which anchors are consistent with a neighbour, or lack two that agree."""
    keep = np.ones(len(counted), bool)
    if len(counted) < 3:
        return keep
    line = device - counted * period
    near = TOLERANCE * period
    alone = (abs(np.diff(line)[:-1]) > near) & (abs(np.diff(line)[1:]) > near)
    keep[1:-1] = ~(alone & (abs(line[2:] - line[:-2]) < 2 * near))
    return keep


def _jumps(steps: Array, latest: Array, counted: Array, device: Array,
           period: float) -> tuple[Array, list[Break]]:
    """Return the seconds before each sample that its count does not explain, and the breaks."""
    extra = np.zeros(len(steps) + 1)
    breaks = []
    lines = np.diff(device - counted * period)
    for where in np.flatnonzero(abs(lines) > TOLERANCE * period):
        low, high = latest[where] + 1, latest[where + 1]
        odd = np.flatnonzero(steps[low - 1:high] != 1)
        index = int(low + odd[0]) if len(odd) else int(high)
        excess = float(lines[where])
        turns, rest = divmod(excess / period + TOLERANCE, COUNTER_MODULUS)
        if device[where + 1] < device[where]:
            seconds = UNKNOWN_PAUSE
            breaks.append(Break(index, BreakKind.RESTARTED, 0, seconds))
            extra[index] = seconds - steps[index - 1] * period
        elif turns > 0 and rest < 2 * TOLERANCE:
            missing = int(turns) * COUNTER_MODULUS + int(steps[index - 1]) - 1
            breaks.append(Break(index, BreakKind.LOST, missing, (missing + 1) * period))
            extra[index] = excess
        else:
            seconds = excess + float(steps[index - 1]) * period
            breaks.append(Break(index, BreakKind.PAUSED, 0, seconds))
            extra[index] = excess
    return extra, breaks


def _assemble(counts: Array, steps: Array, latest: Array, counted: Array, device: Array,
              ahead: int | None, period: float, extra: Array, breaks: list[Break],
              rejected: int) -> TimeAxis:
    jumped = {found.index for found in breaks}
    lost = [Break(int(index) + 1, BreakKind.LOST, int(steps[index]) - 1,
                  float(steps[index]) * period)
            for index in np.flatnonzero(steps > 1) if int(index) + 1 not in jumped]
    seconds = counts * period + np.cumsum(extra)
    device_us = np.full(len(counts), np.nan)
    edges = [0, *sorted(found.index for found in breaks), len(counts)]
    for low, high in zip(edges, edges[1:]):
        mine = (latest >= low) & (latest < high)
        if mine.any():
            # Interpolated between anchors, extrapolated by the period outside.
            here, anchors = counts[low:high], counted[mine]
            line = np.interp(here, anchors, device[mine] - anchors * period)
            true = line + here * period
            device_us[low:high] = true / S_PER_US
            seconds[low:high] = seconds[low] + true - true[0]
    return TimeAxis(seconds - seconds[0], device_us, ahead,
                    period if len(counted) > 1 else None,
                    sorted(breaks + lost, key=lambda found: found.index), len(counted), rejected)
