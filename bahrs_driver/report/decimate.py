# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Reduce a curve to the minimum and maximum of each bucket, with the same look."""

from bahrs_driver.report.time_axis import Array
import numpy as np

BUCKETS = 900           # about the width of a picture in pixels
GAP_SHARE = 0.004       # of the whole time, above which a gap is visible
SHORTEST_GAP = 0.1      # s


def envelope(seconds: Array, values: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """
    Return points whose line looks like that of all values.

    NaN in values, and visible gaps in time, interrupt the line.
    """
    if not len(seconds):
        return np.empty(0), np.empty(0)
    span = seconds[-1] - seconds[0]
    gaps = np.flatnonzero(np.diff(seconds) > max(GAP_SHARE * span, SHORTEST_GAP)) + 1
    if len(seconds) <= 4 * buckets:
        return np.insert(seconds, gaps, seconds[gaps - 1]), np.insert(
            values.astype(float), gaps, np.nan)
    bucket = ((seconds - seconds[0]) / (span or 1.0) * buckets).astype(np.int64)
    starts = np.union1d(np.flatnonzero(np.diff(bucket, prepend=-1)), gaps)
    low = np.fmin.reduceat(values, starts)
    high = np.fmax.reduceat(values, starts)
    first = values[starts]
    rising = abs(first - low) <= abs(first - high)
    pairs = np.stack([np.where(rising, low, high), np.where(rising, high, low)], axis=1)
    after = np.flatnonzero(np.isin(starts, gaps))
    times = np.insert(np.repeat(seconds[starts], 2), 2 * after, seconds[starts[after]])
    return times, np.insert(pairs.ravel().astype(float), 2 * after, np.nan)


def angle_envelope(seconds: Array, degrees: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Return the envelope of an angle from 0 to 360 degrees, interrupted where it passes 360."""
    good = ~np.isnan(degrees)
    unwrapped = np.full(len(degrees), np.nan)
    unwrapped[good] = np.unwrap(degrees[good], period=360.0)
    times, values = envelope(seconds, unwrapped, buckets)
    wrapped = values % 360.0
    passed = np.flatnonzero(abs(np.diff(wrapped)) > 180.0) + 1
    return np.insert(times, passed, times[passed]), np.insert(wrapped, passed, np.nan)


def runs(seconds: Array, states: Array) -> list[tuple[float, float, int]]:
    """Return the intervals of constant state as (begin, end, state), in order."""
    if not len(states):
        return []
    changes = np.flatnonzero(np.diff(states)) + 1
    edges = [0, *changes.tolist(), len(states) - 1]
    return [(float(seconds[begin]), float(seconds[end]), int(states[begin]))
            for begin, end in zip(edges, edges[1:])]
