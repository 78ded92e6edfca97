# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Reduce a curve to the minimum and maximum of each bucket; it looks the same."""

from bahrs_driver.protocol.batch import Array
import numpy as np

BUCKETS = 900           # about the width of a picture in pixels
MIN_GAP_SHARE = 0.004   # of the whole time, above which a gap is visible
MIN_GAP = 0.1           # s


def envelope(seconds: Array, values: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """
    Return the points of a line that looks like the line through all values.

    NaN in values and visible gaps in time interrupt it.
    """
    if not len(seconds):
        return np.empty(0), np.empty(0)
    span = seconds[-1] - seconds[0]
    gaps = np.flatnonzero(np.diff(seconds) > max(MIN_GAP_SHARE * span, MIN_GAP)) + 1
    if len(seconds) <= 4 * buckets:
        return np.insert(seconds, gaps, seconds[gaps - 1]), np.insert(
            values.astype(float), gaps, np.nan)
    starts = np.union1d(bucket_starts(seconds - seconds[0], (span or 1.0) / buckets), gaps)
    low = np.fmin.reduceat(values, starts)
    high = np.fmax.reduceat(values, starts)
    first = values[starts]
    rising = abs(first - low) <= abs(first - high)
    extremes = np.stack([np.where(rising, low, high), np.where(rising, high, low)], axis=1)
    after_gap = np.flatnonzero(np.isin(starts, gaps))
    times = np.insert(np.repeat(seconds[starts], 2), 2 * after_gap, seconds[starts[after_gap]])
    return times, np.insert(extremes.ravel().astype(float), 2 * after_gap, np.nan)


def bucket_starts(seconds: Array, length: float) -> Array:
    """Return the index of the first sample in each interval of a length in s that has any."""
    interval = (seconds / length).astype(np.int64)
    first = np.ones(len(interval), bool)
    np.not_equal(interval[1:], interval[:-1], out=first[1:])
    return np.flatnonzero(first)


def angle_envelope(seconds: Array, degrees: Array, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Return the envelope of an angle from 0 to 360 degrees, interrupted where it passes 360."""
    known = ~np.isnan(degrees)
    unwrapped = np.full(len(degrees), np.nan)
    unwrapped[known] = np.unwrap(degrees[known], period=360.0)
    times, values = envelope(seconds, unwrapped, buckets)
    wrapped = values % 360.0
    passes = np.flatnonzero(abs(np.diff(wrapped)) > 180.0) + 1
    return np.insert(times, passes, times[passes]), np.insert(wrapped, passes, np.nan)
