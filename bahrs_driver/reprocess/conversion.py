# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Regenerate all topics from a capture, with device time estimated from all of it.

Two passes read the capture. The first one collects what the clock needs to know of the whole
recording. The second one runs the pipeline of the driver, which stamps, and converts. Log times of
messages are their stamps without the steps of the host clock (see bag.log_clock).
"""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import NamedTuple

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.feed_capture import ChunkEvents, feed_capture
from bahrs_driver.bag.log_clock import LogClock, LogInstant
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.clock import Clock
from bahrs_driver.convert import raw
from bahrs_driver.convert.values import DiagnosticArray, UInt8MultiArray
from bahrs_driver.devices.parts import Parts
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.pipeline import Event
from bahrs_driver.reprocess import replay_diagnostics
from bahrs_driver.reprocess.decoding_faults import DecodingFaults
from bahrs_driver.reprocess.device_time_capture import DeviceTimeCapture
from bahrs_driver.reprocess.ordered_writer import OrderedWriter
from bahrs_driver.reprocess.replay_diagnostics import ReplayDiagnostics
from bahrs_driver.reprocess.topic_writer import LoggedValues, TopicWriter
from bahrs_driver.units import NS_PER_S

Progress = Callable[[str], None]


class ConversionResult(NamedTuple):
    """Counts and log times of a conversion."""

    frames: int
    skipped_bytes: int
    messages: int
    first_ns: int
    last_ns: int
    clock_steps: list[str]          # a sentence for each time that the host's clock was set


class Conversion:
    """Converts one capture."""

    def __init__(self, capture: Capture, settings: CommonSettings, spec: AnyDevice,
                 start_ns: int | None = None) -> None:
        """
        Convert a capture of a device with the parameters of the driver.

        start_ns is the ROS time of the first time message of a capture without times; without it
        stamps are device time.
        """
        self.notices: list[str] = []        # sentences about the data
        self._capture = capture
        self._settings = settings
        self._spec = spec
        self._start_ns = start_ns

    def run(self, writer: TopicWriter, progress: Progress) -> ConversionResult:
        """Write all topics; progress is called for each chunk with the name of the pass."""
        capture, clock = self._first_pass(progress)
        parts = self._make_parts()
        clock = clock or parts.clock
        pipeline = parts.pipeline(clock)
        topics = self._topics(parts)
        parts.converter.select(topics)
        writer.begin(topics, {topic for topic in topics if topic in self._spec.latched()})
        output, log_clock = OrderedWriter(writer), LogClock()
        second_pass = _SecondPass(parts, output, ReplayDiagnostics(
            self._spec, parts, clock, pipeline.counters, self._settings))
        for fed in feed_capture(capture, pipeline, log_clock):
            progress('converting')
            second_pass.convert(fed)
            if self._capture.timed and fed.chunk.data:
                output.add([(fed.read.log_ns, (raw.TOPIC, self._raw(fed.chunk)))])
            output.write_until(fed.read.log_ns)
        output.write_all()
        self.notices = [*parts.take_notices(), *second_pass.faults.notices()]
        framing = pipeline.counters.framing
        return ConversionResult(framing.frames, framing.skipped_bytes, output.count,
                                output.first_ns, output.last_ns, log_clock.sentences())

    def _make_parts(self) -> Parts:
        return self._spec.parts(self._settings)

    def _topics(self, parts: Parts) -> dict[str, type]:
        topics = dict(self._spec.topics())
        if self._capture.timed:
            topics[raw.TOPIC] = UInt8MultiArray
        return {**topics, **parts.service_topics, replay_diagnostics.TOPIC: DiagnosticArray}

    def _first_pass(self, progress: Progress) -> tuple[Capture, Clock | None]:
        """Return the capture with times, and a clock for it if that of the parts is not enough."""
        parts = self._make_parts()
        recording_format = self._spec.recording_format(self._settings)
        if not self._capture.timed and recording_format:
            timed = DeviceTimeCapture(self._capture, recording_format, parts.time_label,
                                      self._start_ns, progress)
            return timed, timed.clock(round(self._settings.time.fixed_latency * NS_PER_S))
        smoothing = parts.clock.smoothing()
        if smoothing is None:
            return self._capture, None
        pipeline = parts.pipeline(smoothing.first_pass)
        for _ in feed_capture(self._capture, pipeline, LogClock()):
            progress('looking at the clock')
        return self._capture, smoothing.second_pass()

    def _raw(self, chunk: Chunk) -> UInt8MultiArray:
        ros_ns = chunk.ros_ns or 0
        return raw.message(chunk.data, ReadMetadata(
            self._spec.name, chunk.connection_id, self._capture.byte_ns or 0, ros_ns,
            ros_ns if chunk.raw_ns is None else chunk.raw_ns).to_label())


class _SecondPass:
    """Converts the messages of a capture to those of all topics."""

    def __init__(self, parts: Parts, output: OrderedWriter,
                 diagnostics: ReplayDiagnostics) -> None:
        self.faults = DecodingFaults()
        self._parts = parts
        self._output = output
        self._diagnostics = diagnostics

    def convert(self, fed: ChunkEvents) -> None:
        """Add the messages of all topics that a chunk leads to."""
        chunk, read, events, disconnected = fed
        diagnostics = self._diagnostics
        self._output.add(map(_logged, diagnostics.reports_before(read.log_ns)))
        messages = self._converted(events, read)
        if disconnected:
            messages += [(read.log_ns, message)
                         for message in self._parts.converter.end_stream(read.ros_ns)]
        counts = diagnostics.counters.messages
        for topic, count in Counter([topic for _, (topic, _) in messages]).items():
            counts[topic] += count
        self._output.add(messages)
        self._output.add(map(_logged, diagnostics.update(chunk, read, events)))

    def _converted(self, events: Iterable[Event], read: LogInstant) -> list[LoggedValues]:
        convert, offset = self._parts.converter.convert, read.offset
        messages: list[LoggedValues] = []
        for message, _, stamp_ns in self.faults.messages(events):
            log_ns = stamp_ns - offset
            messages += [(log_ns, converted) for converted in convert(message, stamp_ns)]
            self._diagnostics.counters.converted += 1
            if message.SERVICE:
                self._output.add((read.log_ns, converted)
                                 for converted in self._parts.service_messages(message))
        return messages


def _logged(report: tuple[int, DiagnosticArray]) -> LoggedValues:
    log_ns, array = report
    return log_ns, (replay_diagnostics.TOPIC, array)
