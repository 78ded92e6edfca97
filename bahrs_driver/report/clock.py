# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compare the clocks of device and host, from the times at which samples were read.

A sample may arrive late, because line, adapter and host delay it, but never early. So the lower
envelope of the lags shows the drift between the clocks, and the distance from it is the delay.
"""

from dataclasses import dataclass

from bahrs_driver.clock.host import FASTEST_SLEW, STEP
from bahrs_driver.protocol.batch import Array
from bahrs_driver.report.decimate import bucket_starts
from bahrs_driver.report.gather import Recording
from bahrs_driver.units import S_PER_NS, S_PER_US
import numpy as np

BUCKET = 1.0            # s, of each of which the smallest lag counts
MIN_BUCKETS = 10        # for a line through them
STEP_BUCKET = 5.0       # s; a stalled host catches up sooner
MIN_STEP = 1.0          # s


@dataclass(frozen=True)
class ClockAnalysis:
    """Drift of the clocks and delays of samples, in seconds unless the name has another unit."""

    seconds: Array          # times of samples
    delay: Array            # of each sample above the smallest, without the drift
    drift_ppm: float | None         # of the device's clock, positive if faster than the host's
    device_zero: float              # host time at which device time was 0, s since the epoch
    host_steps: int                 # number of times that the host's clock was set
    read_bytes: int                 # median
    longest_pause: float            # between two reads
    delay_99: float                 # 99th percentile


def analyze_clock(recording: Recording) -> ClockAnalysis | None:
    """Compare the clocks; None if reads have no times or samples have no device time."""
    reads, axis = recording.reads, recording.time_axis
    if reads is None or len(reads.ros_ns) < 2:
        return None
    end = recording.inertial_offset + recording.inertial_size
    read = np.searchsorted(reads.received, end)         # the one with the last byte
    known = ~np.isnan(axis.device_us) & (read < len(reads.ros_ns))
    if not known.any():
        return None
    read, seconds = read[known], axis.seconds[known]
    host = reads.ros_ns if reads.raw_ns is None else reads.raw_ns
    arrival = (host[read] - host[0]) * S_PER_NS
    # Bytes after a frame in the same read were transmitted after it.
    transmission = (reads.received[read] - end[known]) * reads.byte_ns * S_PER_NS
    lag = arrival - seconds
    steps = _find_steps(seconds, lag)
    for index, size in steps:
        lag[index:] -= size
    slope, start = _lower_envelope(seconds, lag - transmission)
    delay = lag - start - (slope or 0.0) * seconds
    return ClockAnalysis(
        seconds, delay, drift_ppm=None if slope is None else -slope * 1e6,
        device_zero=float(arrival[0] - axis.device_us[known][0] * S_PER_US
                          + reads.ros_ns[0] * S_PER_NS),
        host_steps=len(steps) if reads.raw_ns is None else _count_steps(
            reads.ros_ns, reads.raw_ns),
        read_bytes=int(np.median(np.diff(reads.received, prepend=0))),
        longest_pause=float(np.diff(host).max()) * S_PER_NS,
        delay_99=float(np.percentile(delay, 99)))


def _count_steps(ros_ns: Array, raw_ns: Array) -> int:
    """Return how often ROS time moved faster than by a slew, against CLOCK_MONOTONIC_RAW."""
    elapsed = np.diff(raw_ns)
    return int((abs(np.diff(ros_ns) - elapsed) > STEP + FASTEST_SLEW * elapsed).sum())


def _find_steps(seconds: Array, lag: Array) -> list[tuple[int, float]]:
    """
    Return (sample, size in seconds) of the steps of the lag.

    While a host stalls, lags grow, but soon return to what they were: that is no step.
    """
    starts = bucket_starts(seconds, STEP_BUCKET)
    smallest = np.minimum.reduceat(lag, starts)
    bounds = [*starts, len(lag)]
    steps = []
    for bucket in np.flatnonzero(abs(np.diff(smallest)) > MIN_STEP):
        size = float(smallest[bucket + 1] - smallest[bucket])
        begin, end = bounds[bucket] + 1, bounds[min(bucket + 2, len(starts))]
        change = np.diff(lag[begin - 1:end])
        steps.append((int(begin + np.argmax(change * np.sign(size))), size))
    return steps


def _lower_envelope(seconds: Array, lag: Array) -> tuple[float | None, float]:
    """Return slope and start of a line below all lags; no slope for too few buckets."""
    starts = bucket_starts(seconds, BUCKET)
    smallest = np.minimum.reduceat(lag, starts)
    if len(starts) < MIN_BUCKETS:
        return None, float(smallest.min())
    # The median of slopes over half the recording: a few seconds of large lags do not change it.
    half, times = len(starts) // 2, seconds[starts]
    slope = float(np.median((smallest[half:] - smallest[:-half]) / (times[half:] - times[:-half])))
    return slope, float((lag - slope * seconds).min())
