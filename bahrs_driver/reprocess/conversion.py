# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A capture through the rooms of the driver once more: every topic, with time known from both sides.

The first pass looks at when bytes were read, and the second one stamps and converts. Messages
are held for some seconds, so that they leave in the order of their log times, which are their
stamps without the steps of the host clock (see `log_clock`).
"""

from collections.abc import Callable, Iterator, Mapping
import heapq
from typing import Any, NamedTuple, Protocol

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.play_capture import play_capture, PlayedChunk
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.clock import Clock
from bahrs_driver.convert import raw
from bahrs_driver.devices.parts import Parts
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.reprocess import replay_diagnostics
from bahrs_driver.reprocess.byte_times import DeviceTimed
from bahrs_driver.reprocess.decoding_faults import DecodingFaults
from bahrs_driver.reprocess.replay_diagnostics import FlightHealth
from bahrs_driver.units import NS_PER_S
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import UInt8MultiArray

HOLD = 10 * NS_PER_S            # that a message may come late in the stream
MOST_HELD = 50_000              # messages, ten times what comes in that time


class Output(Protocol):
    """Where converted messages go, in the order of their times."""

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """Take all topics that there are, and those of which late joiners get the last message."""

    def write(self, topic: str, time_ns: int, message: Any) -> None:
        """Take a message and its ROS time."""


class Outcome(NamedTuple):
    """What came of a conversion. Times are log times."""

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
        self._given = capture
        self._settings = settings
        self._spec = spec
        self._start_ns = start_ns
        self._heap: list[tuple[int, int, str, Any]] = []
        self._count = self._first = self._last = 0
        self._faults = DecodingFaults()
        self.notices: list[str] = []        # sentences about the data

    def run(self, output: Output, progress: Callable[[str], None]) -> Outcome:
        """Convert into an output. progress is called now and then with the name of the pass."""
        capture, clock = self._survey(progress)
        parts = self._make_parts()
        clock = clock or parts.clock
        pipeline = Pipeline(parts.framer, parts.codec, clock)
        topics = dict(self._spec.topics())
        if self._given.timed:
            topics[raw.TOPIC] = UInt8MultiArray
        topics.update(parts.service_topics)
        topics[replay_diagnostics.TOPIC] = DiagnosticArray
        health = FlightHealth(
            self._spec, parts, clock, pipeline.counters, self._settings)
        output.begin(topics, {topic for topic in topics if topic in self._spec.latched()})
        log_clock = LogClock()
        for played in play_capture(capture, pipeline, log_clock):
            progress('converting')
            self._convert(played, parts, health)
            self._release(output, played.moment.log_ns - HOLD)
        self._release(output, None)
        self.notices = [*parts.take_notices(), *self._faults.notices()]
        counters = pipeline.counters.framing
        return Outcome(counters.frames, counters.skipped_bytes, self._count, self._first,
                       self._last, log_clock.sentences())

    def _make_parts(self) -> Parts:
        return self._spec.parts(self._settings)

    def _convert(self, played: PlayedChunk, parts: Parts, health: FlightHealth) -> None:
        chunk, moment, events, lost = played
        now, converter = moment.log_ns, parts.converter
        self._tell(health.before(now))
        for message, _, stamp_ns in self._faults.messages(events):
            self._take(converter.convert(message, stamp_ns), stamp_ns - moment.offset,
                       health.counts)
            for topic, page in parts.service_messages(message):
                self._hold(now, topic, page)
        if lost:
            self._take(converter.lost(moment.ros_ns), now, health.counts)
        self._tell(health.after(chunk, moment, events))
        if self._given.timed and chunk.data:
            self._hold(now, *self._raw(chunk))

    def _survey(self, progress: Callable[[str], None]) -> tuple[Capture, Clock | None]:
        """Return the capture with times, and a clock that knows all of it, if any can."""
        parts = self._make_parts()
        if not self._given.timed and self._spec.roles:
            timed = DeviceTimed(
                self._given, self._spec.roles,
                lambda: Pipeline(self._make_parts().framer, parts.codec),
                parts.time_label, self._start_ns, progress)
            return timed, timed.clock(
                round(self._settings.time.fixed_latency * NS_PER_S))
        smoothing = parts.clock.smoothing()
        if smoothing is None:
            return self._given, None
        first_pass = Pipeline(parts.framer, parts.codec, smoothing.first_pass)
        for _ in play_capture(self._given, first_pass, LogClock()):
            progress('looking at the clock')
        return self._given, smoothing.second_pass()

    def _raw(self, chunk: Chunk) -> tuple[str, UInt8MultiArray]:
        read_at = chunk.read_at or 0
        metadata = ReadMetadata(
            self._spec.name, chunk.opening, self._given.byte_ns or 0, read_at,
            read_at if chunk.raw_at is None else chunk.raw_at)
        return raw.TOPIC, raw.message(chunk.data, metadata.to_label())

    def _take(self, outgoing: Iterator[tuple[str, Any]], log_ns: int,
              counts: dict[str, int]) -> None:
        for topic, message in outgoing:
            counts[topic] += 1
            self._hold(log_ns, topic, message)

    def _tell(self, reports: Iterator[tuple[int, DiagnosticArray]]) -> None:
        for log_ns, array in reports:
            self._hold(log_ns, replay_diagnostics.TOPIC, array)

    def _hold(self, log_ns: int, topic: str, message: Any) -> None:
        heapq.heappush(self._heap, (log_ns, self._count, topic, message))
        self._count += 1

    def _release(self, output: Output, until: int | None) -> None:
        heap = self._heap
        while heap and (until is None or heap[0][0] <= until or len(heap) > MOST_HELD):
            log_ns, _, topic, message = heapq.heappop(heap)
            self._first = self._first or max(0, log_ns)
            self._last = max(log_ns, self._last)
            output.write(topic, self._last, message)
