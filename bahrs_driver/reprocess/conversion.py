# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Regenerate all topics from a capture, with device time estimated from all of it.

Two passes run the pipeline of the driver over the capture. The first one collects what the clock
needs to know of the whole recording, the second one stamps and converts. Log times of messages are
their stamps without the steps of the host clock (see bag.log_clock).
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.play_capture import play_capture, PlayedChunk
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.clock import Clock
from bahrs_driver.convert import raw
from bahrs_driver.devices.parts import Parts
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.pipeline import Unstamped
from bahrs_driver.reprocess import replay_diagnostics
from bahrs_driver.reprocess.byte_times import DeviceTimed
from bahrs_driver.reprocess.decoding_faults import DecodingFaults
from bahrs_driver.reprocess.log_order import LogOrder
from bahrs_driver.reprocess.replay_diagnostics import ReplayDiagnostics
from bahrs_driver.reprocess.topic_writers import TopicWriter
from bahrs_driver.units import NS_PER_S
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import UInt8MultiArray

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
        writer.begin(topics, {topic for topic in topics if topic in self._spec.latched()})
        order, log_clock = LogOrder(writer), LogClock()
        second_pass = _SecondPass(parts, order, ReplayDiagnostics(
            self._spec, parts, clock, pipeline.counters, self._settings))
        for played in play_capture(capture, pipeline, log_clock):
            progress('converting')
            second_pass.convert(played)
            if self._capture.timed and played.chunk.data:
                order.add(played.moment.log_ns, raw.TOPIC, self._raw(played.chunk))
            order.write_until(played.moment.log_ns)
        order.write_all()
        self.notices = [*parts.take_notices(), *second_pass.faults.notices()]
        framing = pipeline.counters.framing
        return ConversionResult(framing.frames, framing.skipped_bytes, order.count,
                                order.first_ns, order.last_ns, log_clock.sentences())

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
        if not self._capture.timed and self._spec.roles:
            timed = DeviceTimed(
                self._capture, self._spec.roles,
                lambda: self._make_parts().pipeline(Unstamped()),
                parts.time_label, self._start_ns, progress)
            return timed, timed.clock(round(self._settings.time.fixed_latency * NS_PER_S))
        smoothing = parts.clock.smoothing()
        if smoothing is None:
            return self._capture, None
        pipeline = parts.pipeline(smoothing.first_pass)
        for _ in play_capture(self._capture, pipeline, LogClock()):
            progress('looking at the clock')
        return self._capture, smoothing.second_pass()

    def _raw(self, chunk: Chunk) -> UInt8MultiArray:
        read_at = chunk.read_at or 0
        return raw.message(chunk.data, ReadMetadata(
            self._spec.name, chunk.opening, self._capture.byte_ns or 0, read_at,
            read_at if chunk.raw_at is None else chunk.raw_at).to_label())


class _SecondPass:
    """Converts the messages of a capture to those of all topics."""

    def __init__(self, parts: Parts, order: LogOrder, diagnostics: ReplayDiagnostics) -> None:
        self.faults = DecodingFaults()
        self._parts = parts
        self._order = order
        self._diagnostics = diagnostics

    def convert(self, played: PlayedChunk) -> None:
        """Add the messages of all topics that a chunk leads to."""
        chunk, moment, events, lost = played
        now, converter = moment.log_ns, self._parts.converter
        self._add_reports(self._diagnostics.reports_before(now))
        for message, _, stamp_ns in self.faults.messages(events):
            self._add(converter.convert(message, stamp_ns), stamp_ns - moment.offset)
            for topic, page in self._parts.service_messages(message):
                self._order.add(now, topic, page)
        if lost:
            self._add(converter.end_stream(moment.ros_ns), now)
        self._add_reports(self._diagnostics.update(chunk, moment, events))

    def _add(self, messages: Iterator[tuple[str, object]], log_ns: int) -> None:
        counts, order = self._diagnostics.counts, self._order
        for topic, message in messages:
            counts[topic] += 1
            order.add(log_ns, topic, message)

    def _add_reports(self, reports: Iterator[tuple[int, DiagnosticArray]]) -> None:
        for log_ns, array in reports:
            self._order.add(log_ns, replay_diagnostics.TOPIC, array)
