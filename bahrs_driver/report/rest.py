# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find when a device was at rest: specific force and angular rate are steady, height too."""

from typing import NamedTuple

from bahrs_driver.protocol.batch import Array
from bahrs_driver.report.decimate import bucket_starts
from bahrs_driver.report.gather import Recording
import numpy as np

WINDOW = 1.0                    # s
WINDOWS = 1000                  # that are summed up at a time
MAX_FORCE_STD = 0.15            # m/s^2, within a window
MAX_FORCE_CHANGE = 0.1          # m/s^2, of the mean from one window to the next
MAX_RATE = 0.01                 # rad/s, mean and standard deviation within a window
MAX_CLIMB = 2.0                 # m/s, up or down
MAX_SAMPLES = 2_000_000         # of a rest, nearly three hours


class Rest(NamedTuple):
    """An interval without motion: samples from begin to before end, and its duration."""

    begin: int
    end: int
    seconds: float


NO_REST = Rest(0, 0, 0.0)


def find_rest(recording: Recording) -> Rest:
    """Return the longest rest in a recording, of at most MAX_SAMPLES."""
    signals = recording.inertial
    force = signals.available('specific_force').copy()
    force[_climbs(recording)] = np.nan
    return longest_rest(signals.seconds, force, signals.available('angular_rate'))


def longest_rest(seconds: Array, force: Array, rate: Array) -> Rest:
    """
    Return the longest rest without a gap in the samples, of at most MAX_SAMPLES.

    seconds are the times of samples; force (m/s^2) and rate (rad/s) are (n, 3), NaN where not
    available.
    """
    if len(seconds) < 2:
        return NO_REST
    starts = bucket_starts(seconds, WINDOW)
    counts = np.diff(np.append(starts, len(seconds)))[:, None]
    force_mean, force_std = _statistics(force, starts, counts)
    rate_mean, rate_std = _statistics(rate, starts, counts)
    turned = abs(np.diff(force_mean, axis=0, prepend=force_mean[:1])) > MAX_FORCE_CHANGE
    with np.errstate(invalid='ignore'):
        still: Array = np.all((force_std < MAX_FORCE_STD) & (rate_std < MAX_RATE)
                              & (abs(rate_mean) < MAX_RATE) & ~turned, axis=1)
    steps = np.diff(seconds)
    gaps = np.flatnonzero(steps > 1.5 * np.median(steps)) + 1
    still[np.searchsorted(starts, gaps, side='right') - 1] = False
    edges = np.flatnonzero(np.diff(still.astype(np.int8), prepend=0, append=0))
    rests = edges.reshape(-1, 2)
    if not len(rests):
        return NO_REST
    first, last = rests[np.argmax(rests[:, 1] - rests[:, 0])]
    begin = int(starts[first])
    end = min(int(np.append(starts, len(seconds))[last]), begin + MAX_SAMPLES)
    return Rest(begin, end, float(seconds[end - 1] - seconds[begin]))


def _climbs(recording: Recording) -> Array:
    """Return for each inertial sample whether the device climbs or descends."""
    # Force and rate of a steady climb are those at rest.
    signals, seconds = recording.navigation, recording.inertial.seconds
    climbs = abs(signals.available('velocity_down')) > MAX_CLIMB
    if not len(climbs):
        return np.zeros(len(seconds), bool)
    after = np.searchsorted(signals.seconds, seconds)
    return np.asarray(climbs[np.minimum(after, len(climbs) - 1, out=after)])


def _statistics(values: Array, starts: Array, counts: Array) -> tuple[Array, Array]:
    """Return mean and standard deviation of each component in each window."""
    mean, square = np.empty((len(starts), 3)), np.empty((len(starts), 3))
    for first in range(0, len(starts), WINDOWS):        # copies of all samples are too large
        windows = slice(first, first + WINDOWS)
        begin, end = starts[first], int(starts[windows][-1] + counts[windows][-1, 0])
        samples = values[begin:end].astype(np.float64)
        mean[windows] = np.add.reduceat(samples, starts[windows] - begin)
        square[windows] = np.add.reduceat(samples ** 2, starts[windows] - begin)
    mean /= counts
    square /= counts
    return mean, np.sqrt(np.maximum(square - mean ** 2, 0.0))
