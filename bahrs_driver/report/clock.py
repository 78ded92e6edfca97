# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The device's clock beside the host's, from when samples were read.

What a sample's arrival is late by is the delay of the line, the adapter and the host; it is never
early. The lower envelope of the delays therefore tells how the two clocks drift apart, and what
lies above it how unevenly data arrives.
"""

from dataclasses import dataclass

from bahrs_driver.report.gather import Recording
from bahrs_driver.report.timeline import Array
import numpy as np

NANOSECOND = 1e-9
BUCKET = 1.0            # s, in which the least delay is looked for
ENOUGH = 10             # buckets for a line through them


@dataclass(frozen=True)
class ClockStory:
    """How the clocks went, and how data arrived. Seconds, but where a name says otherwise."""

    seconds: Array          # of samples
    delay: Array            # of each beyond the least there can be, drift taken off
    drift_ppm: float | None         # by how much the device's clock is faster than the host's
    device_zero: float              # host time at which device time was 0, s since the epoch
    host_steps: int                 # times that the host's clock was set
    read_bytes: int                 # median
    longest_pause: float            # between two reads
    late_99: float                  # what 99 of 100 samples are less late by than this


def clock_story(recording: Recording) -> ClockStory | None:
    """Compare the clocks; None if reads have no times, or samples no device time."""
    reads, axis = recording.reads, recording.timeline
    known = ~np.isnan(axis.device_us)
    if reads is None or len(reads.ros_ns) < 2 or not known.any():
        return None
    number = np.searchsorted(reads.received, recording.inertial_end)
    known &= number < len(reads.ros_ns)
    if not known.any():
        return None
    number, seconds = number[known], axis.seconds[known]
    arrival = (reads.ros_ns[number] - reads.ros_ns[0]) * NANOSECOND
    # Bytes that came behind a frame in the same read took their time on the line after it.
    behind = (reads.received[number] - recording.inertial_end[known]) * reads.byte_ns * NANOSECOND
    late = arrival - seconds
    offset = float(arrival[0] - axis.device_us[known][0] * 1e-6)
    steps = _steps(late)
    for index in steps:
        late[index:] -= late[index] - late[index - 1]
    drift, base = _envelope(seconds, late - behind)
    delay = late - (base + (drift or 0.0) * seconds)
    sizes = np.diff(reads.received, prepend=0)
    return ClockStory(
        seconds, delay, None if drift is None else -drift * 1e6,
        offset + float(reads.ros_ns[0]) * NANOSECOND, len(steps), int(np.median(sizes)),
        float(np.diff(reads.ros_ns).max()) * NANOSECOND, float(np.percentile(delay, 99)))


def _steps(late: Array) -> list[int]:
    """Return the samples from which on everything is later or earlier by more than a second."""
    return [int(index) + 1 for index in np.flatnonzero(abs(np.diff(late)) > 1.0)]


def _envelope(seconds: Array, late: Array) -> tuple[float | None, float]:
    """Return slope and start of a line below all delays; no slope if there are too few."""
    bucket = (seconds / BUCKET).astype(np.int64)
    starts = np.flatnonzero(np.diff(bucket, prepend=-1))
    least = np.minimum.reduceat(late, starts)
    middle = seconds[starts]
    if len(starts) < ENOUGH:
        return None, float(least.min())
    slope = float(np.polyfit(middle, least, 1)[0])
    return slope, float((late - slope * seconds).min())
