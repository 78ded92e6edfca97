# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read a recording into arrays, a piece at a time."""

from array import array
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from bahrs_driver.bag.capture import Capture
from bahrs_driver.bag.feed_capture import feed_capture
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.devices.recording_format import Limits, RecordingFormat
from bahrs_driver.pipeline import Pipeline, PipelineCounters
from bahrs_driver.protocol.batch import Batch
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Frame, Framer, FramingCounters
from bahrs_driver.protocol.message import Message
from bahrs_driver.report.time_axis import Array, make_time_axis, TimeAxis
from bahrs_driver.units import COUNTER_MODULUS
import numpy as np


@dataclass(frozen=True)
class Signals:
    """The messages of one type: times (s), values and integrity."""

    seconds: Array
    values: dict[str, Array]            # by the name of the field; float32
    health: Array                       # (n, signals), the numbers of Integrity
    names: tuple[str, ...]              # of the signals


@dataclass(frozen=True)
class Reads:
    """The reads of the host."""

    ros_ns: Array
    raw_ns: Array | None                # on CLOCK_MONOTONIC_RAW, if recorded
    received: Array                     # bytes of the stream after each read
    byte_ns: int                        # transmission time of a byte; 0 if unknown


@dataclass(frozen=True)
class Recording:
    """The data of a report."""

    name: str
    device: str                         # label
    limits: Mapping[str, Limits]        # of saturated fields
    size: int                           # bytes of the stream
    counters: FramingCounters
    counts: dict[str, int]              # frames by the name of the message
    versions: dict[int, int]            # frames by protocol version
    crc_order: str | None
    software: Any                       # version message, if received
    hardware: Any                       # version message, if received
    time_axis: TimeAxis
    inertial: Signals
    navigation: Signals
    accuracy: Signals
    pulses: Array                       # times of sync pulses, s
    navigation_label: int | None        # by how many the sample is ahead that time messages name
    reads: Reads | None
    inertial_end: Array                 # offset of the byte after each inertial frame
    openings: int                       # of the port
    notes: list[str]

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last."""
        return float(self.time_axis.seconds[-1]) if len(self.time_axis.seconds) else 0.0


_EMPTY = Message()


class _FrameCollector(Decoder):
    """A decoder that keeps frames, to decode many of them at once."""

    def __init__(self) -> None:
        self._frames: list[Frame] = []

    def decode(self, frame: Frame, _now: int) -> Message:
        """Keep a frame, and return an empty message."""
        self._frames.append(frame)
        return _EMPTY

    def take(self) -> list[Frame]:
        """Return the frames since the last call."""
        frames, self._frames = self._frames, []
        return frames


def gather(capture: Capture, recorded: RecordingFormat,
           progress: Callable[[], None] = lambda: None) -> Recording:
    """Read a capture; progress is called after each piece. CaptureError if it cannot be read."""
    collector, batch = _FrameCollector(), Batch(recorded.layouts)
    pipeline = Pipeline(Framer(recorded.frame_format), collector)
    times, raws, received = array('q'), array('q'), array('q')      # there are millions
    for chunk, *_ in feed_capture(capture, pipeline, LogClock()):
        batch.add(collector.take())
        if chunk.data and chunk.ros_ns is not None:
            times.append(chunk.ros_ns)
            if chunk.raw_ns is not None:
                raws.append(chunk.raw_ns)
            received.append(pipeline.received)
        progress()
    reads = Reads(np.array(times), np.array(raws) if len(raws) == len(times) else None,
                  np.array(received), capture.byte_ns or 0) if times else None
    return _recording(capture, batch, pipeline.counters, recorded, reads)


def _recording(capture: Capture, batch: Batch, counters: PipelineCounters,
               recorded: RecordingFormat, reads: Reads | None) -> Recording:
    counts, versions = Counter[str](), Counter[int]()
    for header, count in batch.counts().items():
        counts[recorded.layouts[header].message.NAME] += count
        versions[recorded.version(header)] += count
    roles = recorded.roles
    inertial, navigation = batch.take(roles.sample), batch.take(roles.navigation)
    accuracy = batch.take(recorded.accuracy)
    axis = make_time_axis(inertial['offset'], inertial['sequence'], batch.take(roles.sample_time))
    offsets = inertial['offset'].copy()

    def when(array: Array) -> Array:
        """Return the times of messages: those of the inertial samples before them."""
        if not len(offsets):
            return np.arange(len(array)) * 0.01
        return np.asarray(axis.seconds[np.searchsorted(offsets, array['offset']).clip(1) - 1])

    usual = versions.most_common(1)[0][0] if versions else None
    return Recording(
        capture.path.name, recorded.label, recorded.limits(max(versions, default=None)),
        counters.bytes_received, counters.framing, dict(counts), dict(versions),
        recorded.checksum_order(), _last(recorded.software, batch),
        _last(recorded.hardware, batch), axis, _signals(roles.sample, axis.seconds, inertial),
        _signals(roles.navigation, when(navigation), navigation),
        _signals(recorded.accuracy, when(accuracy), accuracy),
        when(batch.take(roles.sync_pulse)),
        _label(navigation, batch.take(roles.navigation_time)), reads,
        offsets + recorded.sample_size(usual), counters.streams, capture.notes)


def _signals(kind: type[Message], seconds: Array, array: Array) -> Signals:
    names = [name for name in array.dtype.names or ()
             if name not in ('offset', 'sequence', 'health', 'device_time_us')]
    health = array['health'].copy() if kind.SIGNALS else np.empty((len(array), 0), np.uint8)
    return Signals(seconds, {name: array[name].astype(np.float32) for name in names}, health,
                   kind.SIGNALS)


def _last(kind: type[Message], batch: Batch) -> Message | None:
    """Return the last message of a type; None if there is none."""
    array = batch.take(kind)
    if not len(array):
        return None
    return kind(*(
        item if isinstance(item, str) else tuple(item.tolist()) if item.shape else int(item)
        for item in list(array[-1])[1:]))


def _label(navigation: Array, times: Array) -> int | None:
    """Return by how many the navigation message is ahead that time messages name."""
    times = times[times['device_time_us'] != 0]
    latest = np.searchsorted(navigation['offset'], times['offset']) - 1
    times, latest = times[latest >= 0], latest[latest >= 0]
    if not len(times):
        return None
    ahead = times['reference_sequence'].astype(int) - navigation['sequence'][latest]
    half = COUNTER_MODULUS // 2
    return int(np.median((ahead + half) % COUNTER_MODULUS - half))
