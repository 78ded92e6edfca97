# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read a recording of a BAHRS into arrays, a piece at a time."""

from array import array
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from bahrs_driver.bag.capture import Capture
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.play_capture import play_capture
from bahrs_driver.pipeline import Pipeline, PipelineCounters
from bahrs_driver.protocol.bahrs.frames import (
    BahrsCodec, BahrsFormat, frame_size, frame_version, HEADER, MARKER,
)
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, BahrsMessage, HardwareVersion, HeightFormat, Inertial, InertialTime, Navigation,
    NavigationTime, SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.batch import Batch
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Frame, Framer, FramingCounters
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
    size: int                           # bytes of the stream
    counters: FramingCounters
    counts: dict[str, int]              # frames by the name of the message
    versions: dict[int, int]            # frames by protocol version
    crc_order: str | None
    software: SoftwareVersion | None
    hardware: HardwareVersion | None
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


class _FrameCollector(Decoder):
    """A decoder that keeps frames, to decode many of them at once."""

    def __init__(self) -> None:
        self._frames: list[Frame] = []

    def decode(self, frame: Frame, _now: int) -> None:
        """Keep a frame."""
        self._frames.append(frame)

    def take(self) -> list[Frame]:
        """Return the frames since the last call."""
        frames, self._frames = self._frames, []
        return frames


def gather(capture: Capture, crc: Literal['auto', 'word', 'byte'] = 'auto',
           height_format: HeightFormat = 'uint16',
           progress: Callable[[], None] = lambda: None) -> Recording:
    """Read a capture; progress is called after each piece. CaptureError if it cannot be read."""
    frame_format, codec = BahrsFormat(crc), BahrsCodec(height_format)
    collector, batch = _FrameCollector(), Batch(codec.layouts_by_header)
    pipeline = Pipeline(Framer(frame_format), collector)
    times, raws, received = array('q'), array('q'), array('q')      # there are millions
    for chunk, *_ in play_capture(capture, pipeline, LogClock()):
        batch.add(collector.take())
        if chunk.data and chunk.read_at is not None:
            times.append(chunk.read_at)
            if chunk.raw_at is not None:
                raws.append(chunk.raw_at)
            received.append(pipeline.received)
        progress()
    reads = Reads(np.array(times), np.array(raws) if len(raws) == len(times) else None,
                  np.array(received), capture.byte_ns or 0) if times else None
    return _recording(capture, batch, pipeline.counters, frame_format, codec, reads)


def _recording(capture: Capture, batch: Batch, counters: PipelineCounters,
               frame_format: BahrsFormat, codec: BahrsCodec, reads: Reads | None) -> Recording:
    counts, versions = Counter[str](), Counter[int]()
    for header, count in batch.counts().items():
        counts[codec.layouts_by_header[header].message.NAME] += count
        versions[frame_version(header)] += count
    inertial, navigation = batch.take(Inertial), batch.take(Navigation)
    axis = make_time_axis(inertial['offset'], inertial['sequence'], batch.take(InertialTime))
    offsets = inertial['offset'].copy()

    def when(array: Array) -> Array:
        """Return the times of messages: those of the inertial samples before them."""
        if not len(offsets):
            return np.arange(len(array)) * 0.01
        return np.asarray(axis.seconds[np.searchsorted(offsets, array['offset']).clip(1) - 1])

    software, hardware = batch.take(SoftwareVersion), batch.take(HardwareVersion)
    return Recording(
        capture.path.name, counters.bytes_received, counters.framing, dict(counts), dict(versions),
        frame_format.order_seen,
        SoftwareVersion(*_last(software)) if len(software) else None,
        HardwareVersion(*_last(hardware)) if len(hardware) else None,
        axis, _signals(Inertial, axis.seconds, inertial),
        _signals(Navigation, when(navigation), navigation),
        _signals(Accuracy, when(accuracy := batch.take(Accuracy)), accuracy),
        when(batch.take(SyncPulseTime)), _label(navigation, batch.take(NavigationTime)), reads,
        offsets + _inertial_size(codec, versions), counters.streams, capture.notes)


def _signals(kind: type[BahrsMessage], seconds: Array, array: Array) -> Signals:
    names = [name for name in array.dtype.names or ()
             if name not in ('offset', 'sequence', 'health', 'device_time_us')]
    health = array['health'].copy() if kind.SIGNALS else np.empty((len(array), 0), np.uint8)
    return Signals(seconds, {name: array[name].astype(np.float32) for name in names}, health,
                   kind.SIGNALS)


def _last(array: Array) -> list[Any]:
    """Return the fields of the last message."""
    return [item if isinstance(item, str) else tuple(item.tolist()) if item.shape else int(item)
            for item in list(array[-1])[1:]]


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


def _inertial_size(codec: BahrsCodec, versions: Counter[int]) -> int:
    version = versions.most_common(1)[0][0] if versions else 3
    layout = codec.layouts_by_header[HEADER.pack(MARKER, version, Inertial.TYPE)]
    return frame_size(layout.size, padded=True)
