# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find when a device was at rest."""

from typing import NamedTuple

from bahrs_driver.report.time_axis import Array
import numpy as np

WINDOW = 1.0                    # s
STILL_FORCE = 0.15              # m/s^2, standard deviation within a window
STILL_RATE = 0.01               # rad/s, the same, and mean
TURN_OF_FORCE = 0.1             # m/s^2, by which the mean may differ from the window before


class Rest(NamedTuple):
    """The longest interval without motion: samples from begin to end."""

    begin: int
    end: int


def longest_rest(seconds: Array, force: Array, rate: Array) -> Rest:
    """
    Return the longest rest of a device without a gap in the samples.

    force (m/s^2) and rate (rad/s) are (n, 3), NaN where not available; begin is end if never.
    """
    if len(seconds) < 2:
        return Rest(0, 0)
    starts = np.flatnonzero(np.diff((seconds / WINDOW).astype(np.int64), prepend=-1))
    counts = np.diff(np.append(starts, len(seconds)))[:, None]
    force_mean, force_std = _statistics(force, starts, counts)
    rate_mean, rate_std = _statistics(rate, starts, counts)
    turned = abs(np.diff(force_mean, axis=0, prepend=force_mean[:1])) > TURN_OF_FORCE
    with np.errstate(invalid='ignore'):
        still: Array = np.all((force_std < STILL_FORCE) & (rate_std < STILL_RATE)
                              & (abs(rate_mean) < STILL_RATE) & ~turned, axis=1)
    period = np.median(np.diff(seconds))
    gaps = np.flatnonzero(np.diff(seconds) > 1.5 * period) + 1
    still[np.searchsorted(starts, gaps, side='right') - 1] = False
    edges = np.flatnonzero(np.diff(still.astype(np.int8), prepend=0, append=0))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return Rest(0, 0)
    first, last = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return Rest(int(starts[first]), int(np.append(starts, len(seconds))[last]))


def _statistics(values: Array, starts: Array, counts: Array) -> tuple[Array, Array]:
    """Return mean and standard deviation of each component in each window."""
    values = values.astype(np.float64)
    mean = np.add.reduceat(values, starts) / counts
    square = np.add.reduceat(values ** 2, starts) / counts
    return mean, np.sqrt(np.maximum(square - mean ** 2, 0.0))
