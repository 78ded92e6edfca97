# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compare the clocks of device and host, from the times at which samples were read.

A sample arrives late by the delay of the line, the adapter and the host, and never early. So the
lower envelope of the delays shows the drift between the clocks, and the distance from it how
unevenly data arrives.
"""

from dataclasses import dataclass

from bahrs_driver.clock.host import FASTEST_SLEW, STEP
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.time_axis import Array
from bahrs_driver.units import S_PER_NS, S_PER_US
import numpy as np

BUCKET = 1.0            # s, of each of which the smallest delay counts
MIN_BUCKETS = 10        # for a line through them
SPAN = 5.0              # s; a step of the delay lasts longer


@dataclass(frozen=True)
class ClockAnalysis:
    """Drift of the clocks and delays of samples, in seconds unless the name has another unit."""

    seconds: Array          # of samples
    delay: Array            # of each sample above the smallest, without the drift
    drift_ppm: float | None         # of the device's clock, positive if faster than the host's
    device_zero: float              # host time at which device time was 0, s since the epoch
    host_steps: int                 # number of times that the host's clock was set
    read_bytes: int                 # median
    longest_pause: float            # between two reads
    late_99: float                  # percentile 99 of the delays


def analyze_clock(recording: Recording) -> ClockAnalysis | None:
    """Compare the clocks; None if reads have no times or samples have no device time."""
    reads, axis = recording.reads, recording.time_axis
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
    # Bytes after a frame in the same read were transmitted after it.
    behind = (reads.received[number] - recording.inertial_end[known]) * reads.byte_ns * S_PER_NS
    late = arrival - seconds
    offset = float(arrival[0] - axis.device_us[known][0] * S_PER_US)
    jumps = _jumps(seconds, late)
    for index, size in jumps:
        late[index:] -= size
    drift, base = _envelope(seconds, late - behind)
    delay = late - (base + (drift or 0.0) * seconds)
    sizes = np.diff(reads.received, prepend=0)
    return ClockAnalysis(
        seconds, delay, None if drift is None else -drift * 1e6,
        offset + float(reads.ros_ns[0]) * S_PER_NS,
        len(jumps) if reads.raw_ns is None else _times_set(reads.ros_ns, reads.raw_ns),
        int(np.median(sizes)), float(np.diff(host).max()) * S_PER_NS,
        float(np.percentile(delay, 99)))


def _times_set(ros_ns: Array, raw_ns: Array) -> int:
    """Return how often ROS time moved faster than by a slew, against CLOCK_MONOTONIC_RAW."""
    elapsed = np.diff(raw_ns)
    return int((abs(np.diff(ros_ns) - elapsed) > STEP + FASTEST_SLEW * elapsed).sum())


def _jumps(seconds: Array, late: Array) -> list[tuple[int, float]]:
    """
    Return the samples at which the delay steps by a second or more, and the steps in seconds.

    The delays of a stalled host are not steps: they end soon.
    """
    starts = _starts(seconds, SPAN)
    least = np.minimum.reduceat(late, starts)
    bounds = [*starts, len(late)]
    found = []
    for bucket in np.flatnonzero(abs(np.diff(least)) > 1.0):
        size = float(least[bucket + 1] - least[bucket])
        low, high = bounds[bucket] + 1, bounds[min(bucket + 2, len(starts))]
        change = np.diff(late[low - 1:high])
        found.append((int(low + np.argmax(change * np.sign(size))), size))
    return found


def _starts(seconds: Array, span: float) -> Array:
    """Return the first sample of each span in seconds that has any."""
    return np.flatnonzero(np.diff((seconds / span).astype(np.int64), prepend=-1))


def _envelope(seconds: Array, late: Array) -> tuple[float | None, float]:
    """Return slope and start of a line below all delays; no slope for too few buckets."""
    starts = _starts(seconds, BUCKET)
    least = np.minimum.reduceat(late, starts)
    if len(starts) < MIN_BUCKETS:
        return None, float(least.min())
    # The median of slopes over half the recording: some late seconds do not change it.
    half = len(starts) // 2
    slopes = (least[half:] - least[:-half]) / (seconds[starts][half:] - seconds[starts][:-half])
    slope = float(np.median(slopes))
    return slope, float((late - slope * seconds).min())
