# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Read a recording into arrays."""

from array import array
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
from typing import Any

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.devices.recording_format import Limits, RecordingFormat
from bahrs_driver.pipeline import PipelineCounters
from bahrs_driver.protocol.batch import Array, Batch, Columns
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import FramingCounters
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.message import Message
from bahrs_driver.report.time_axis import make_time_axis, TimeAxis
from bahrs_driver.units import S_PER_NS
import numpy as np

BLOCK = 1_048_576       # bytes that are searched for frames at a time
_NOT_VALUES = {'offset', 'sequence', 'health', 'device_time_us'}
_AVAILABLE = np.array([state.available for state in sorted(Integrity)])


@dataclass(frozen=True)
class Signals:
    """The messages of one type: times (s), values and integrity."""

    seconds: Array
    values: dict[str, Array]            # by the name of the field; float32
    health: Array                       # (n, signals), the numbers of Integrity
    names: tuple[str, ...]              # of the signals: a vector has one per component
    rate: float = math.nan              # Hz, nominal

    def available(self, field: str) -> Array:
        """
        Return the values of a field, NaN where the device reports them as not available.

        The array is that of `values` if all are available: do not change it.
        """
        names = (field, *(f'{field}_{axis}' for axis in 'xyz'))
        values = self.values[field]
        available = _AVAILABLE[self.health[:, [name in names for name in self.names]]]
        if available.all():
            return values
        return np.where(available.reshape(values.shape), values, np.float32(np.nan))


@dataclass(frozen=True)
class Reads:
    """The reads of the host."""

    ros_ns: Array
    raw_ns: Array | None                # on CLOCK_MONOTONIC_RAW, if recorded
    received: Array                     # bytes of the stream up to the end of each read
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
    reads: Reads | None
    inertial_offset: Array              # of the first byte of each inertial frame
    inertial_size: int                  # bytes of each inertial frame
    openings: int                       # times that the port was opened
    notes: list[str]

    @property
    def duration(self) -> float:
        """Seconds from the first sample to the last."""
        return float(self.time_axis.seconds[-1]) if len(self.time_axis.seconds) else 0.0


class _FrameReader:
    """Collects the frames of the chunks of a capture, many at a time."""

    def __init__(self, recording_format: RecordingFormat) -> None:
        self.batch = Batch(recording_format.layouts, np.float32)
        self._framer = BlockFramer(recording_format.frame_format)
        self.counters = PipelineCounters(self._framer.framer.counters)
        self._chunks: list[bytes] = []
        self._size = 0                      # of the chunks that wait
        self._connection_id: int | None = None

    def feed(self, chunk: Chunk) -> int:
        """Add a chunk; return the offset of the byte after it."""
        if chunk.connection_id != self._connection_id:
            self.close()
            self._connection_id = chunk.connection_id
            self.counters.streams += 1
        self._chunks.append(chunk.data)
        self._size += len(chunk.data)
        self.counters.bytes_received += len(chunk.data)
        if self._size >= BLOCK:
            self._take()
        return self.counters.bytes_received

    def close(self) -> None:
        """End a stream."""
        self._take()
        self.batch.add(self._framer.flush())

    def _take(self) -> None:
        for found in self._framer.feed(b''.join(self._chunks)):
            if isinstance(found, FrameBlock):
                self.batch.add_block(found)
            else:
                self.batch.add(found)
        self._chunks.clear()
        self._size = 0


def gather(capture: Capture, recording_format: RecordingFormat,
           progress: Callable[[], None] = lambda: None) -> Recording:
    """
    Read a capture.

    progress is called after each chunk. Raise CaptureError if the capture cannot be read.
    """
    reader = _FrameReader(recording_format)
    ros_ns, raw_ns, received = array('q'), array('q'), array('q')   # there are millions of reads
    for chunk in capture.chunks():
        end = reader.feed(chunk)
        if chunk.data and chunk.ros_ns is not None:
            ros_ns.append(chunk.ros_ns)
            if chunk.raw_ns is not None:
                raw_ns.append(chunk.raw_ns)
            received.append(end)
        progress()
    reader.close()
    reads = Reads(np.array(ros_ns), np.array(raw_ns) if len(raw_ns) == len(ros_ns) else None,
                  np.array(received), capture.byte_ns or 0) if ros_ns else None
    return _recording(capture, reader.batch, reader.counters, recording_format, reads)


def _recording(capture: Capture, batch: Batch, counters: PipelineCounters,
               recording_format: RecordingFormat, reads: Reads | None) -> Recording:
    counts, versions = _count_frames(batch, recording_format)
    roles, period = recording_format.roles, recording_format.roles.sample_period * S_PER_NS
    samples = batch.take(roles.sample)
    offset = samples['offset']
    axis = make_time_axis(offset, samples['sequence'], batch.take(roles.sample_time), period)

    def times(messages: Columns) -> Array:
        if not len(offset):
            return np.arange(len(messages['offset'])) * period * roles.samples_per_navigation
        # Those of the samples before; clock.navigation counts to the same ones, 150 times slower.
        latest = np.searchsorted(offset, messages['offset']).clip(1) - 1
        return np.asarray(axis.seconds[latest])

    def signals(message: type[Message], rate: float = math.nan) -> Signals:
        messages = batch.take(message)
        return _signals(message, times(messages), messages, rate)

    return Recording(
        capture.path.name, recording_format.label,
        recording_format.limits(max(versions, default=None)), counters.bytes_received,
        counters.framing, dict(counts), dict(versions), recording_format.checksum_order(),
        _last(recording_format.software, batch), _last(recording_format.hardware, batch), axis,
        inertial=_signals(roles.sample, axis.seconds, samples, 1 / period),
        navigation=signals(roles.navigation, 1 / period / roles.samples_per_navigation),
        accuracy=signals(recording_format.accuracy), pulses=times(batch.take(roles.sync_pulse)),
        reads=reads, inertial_offset=offset, inertial_size=recording_format.sample_size(
            max(versions, key=versions.__getitem__, default=None)),
        openings=counters.streams, notes=capture.notes)


def _count_frames(batch: Batch, recording_format: RecordingFormat
                  ) -> tuple[Counter[str], Counter[int]]:
    """Count frames by the name of the message, and by protocol version."""
    counts, versions = Counter[str](), Counter[int]()
    for header, count in batch.counts().items():
        counts[recording_format.layouts[header].message.NAME] += count
        versions[recording_format.version(header)] += count
    return counts, versions


def _signals(message: type[Message], seconds: Array, messages: Columns, rate: float) -> Signals:
    values = {name: column for name, column in messages.items() if name not in _NOT_VALUES}
    health = messages['health'] if message.SIGNALS else np.empty((len(seconds), 0), np.uint8)
    return Signals(seconds, values, health, message.SIGNALS, rate)


def _last(message: type[Message], batch: Batch) -> Message | None:
    """Return the last message of a type; None if there is none."""
    offset, *fields = batch.take(message).values()
    if not len(offset):
        return None
    values = [column[-1:].tolist()[0] for column in fields]
    return message(*(tuple(value) if isinstance(value, list) else value for value in values))
