# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The device's clock beside the host's, from when samples were read.

What a sample's arrival is late by is the delay of the line, the adapter and the host; it is never
early. The lower envelope of the delays therefore tells how the two clocks drift apart, and what
lies above it how unevenly data arrives.
"""

from dataclasses import dataclass

from bahrs_driver.clock.host import FASTEST_SLEW, STEP
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.timeline import Array
from bahrs_driver.units import S_PER_NS, S_PER_US
import numpy as np

BUCKET = 1.0            # s, in which the least delay is looked for
ENOUGH = 10             # buckets for a line through them
SPAN = 5.0              # s; what is late for so long stays so


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
    host = reads.ros_ns if reads.raw_ns is None else reads.raw_ns
    arrival = (host[number] - host[0]) * S_PER_NS
    # Bytes that came behind a frame in the same read took their time on the line after it.
    behind = (reads.received[number] - recording.inertial_end[known]) * reads.byte_ns * S_PER_NS
    late = arrival - seconds
    offset = float(arrival[0] - axis.device_us[known][0] * S_PER_US)
    jumps = _jumps(seconds, late)
    for index, size in jumps:
        late[index:] -= size
    drift, base = _envelope(seconds, late - behind)
    delay = late - (base + (drift or 0.0) * seconds)
    sizes = np.diff(reads.received, prepend=0)
    return ClockStory(
        seconds, delay, None if drift is None else -drift * 1e6,
        offset + float(reads.ros_ns[0]) * S_PER_NS,
        len(jumps) if reads.raw_ns is None else _times_set(reads.ros_ns, reads.raw_ns),
        int(np.median(sizes)), float(np.diff(host).max()) * S_PER_NS,
        float(np.percentile(delay, 99)))


def _times_set(ros_ns: Array, raw_ns: Array) -> int:
    """Return how often ROS time moved against a clock that nobody sets, faster than by a slew."""
    elapsed = np.diff(raw_ns)
    return int((abs(np.diff(ros_ns) - elapsed) > STEP + FASTEST_SLEW * elapsed).sum())


def _jumps(seconds: Array, late: Array) -> list[tuple[int, float]]:
    """
    Return the samples from which on everything is late by another second or more, and by how many.

    What a stalled host is late for is none of these: it is soon prompt again. Below 0 is early.
    """
    starts = _starts(seconds, SPAN)
    least = np.minimum.reduceat(late, starts)
    bounds = [*starts, len(late)]
    found = []
    for place in np.flatnonzero(abs(np.diff(least)) > 1.0):
        size = float(least[place + 1] - least[place])
        low, high = bounds[place] + 1, bounds[min(place + 2, len(starts))]
        change = np.diff(late[low - 1:high])
        found.append((int(low + np.argmax(change * np.sign(size))), size))
    return found


def _starts(seconds: Array, span: float) -> Array:
    """Return the first sample of each span of so many seconds that has any."""
    return np.flatnonzero(np.diff((seconds / span).astype(np.int64), prepend=-1))


def _envelope(seconds: Array, late: Array) -> tuple[float | None, float]:
    """Return slope and start of a line below all delays; no slope if there are too few."""
    starts = _starts(seconds, BUCKET)
    least = np.minimum.reduceat(late, starts)
    if len(starts) < ENOUGH:
        return None, float(least.min())
    # The median of slopes over half the recording: some seconds that are late bend it nowhere.
    half = len(starts) // 2
    slopes = (least[half:] - least[:-half]) / (seconds[starts][half:] - seconds[starts][:-half])
    slope = float(np.median(slopes))
    return slope, float((late - slope * seconds).min())
