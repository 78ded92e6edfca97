# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Bytes in, stamped messages out.

    framer (bytes -> frames) -> decoder (frame -> message) -> clock (message -> stamp)

The decoder then resolves answers whose payload cannot be decoded before they have a stamp. The
live reader, `bahrs convert` and `bahrs decode` differ in the source of bytes and the destination
of messages; between the two, all of them use this class. Only what needs no stamps, such as
`bahrs report` and the summary of `bahrs decode`, may find frames in blocks instead. It does no
I/O, reads no clock and transmits nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from bahrs_driver.clock.interface import Clock, Instant
from bahrs_driver.pipeline.events import DecodingFault, Event, Notice
from bahrs_driver.pipeline.unstamped import Unstamped
from bahrs_driver.protocol.decoder import Decoder
from bahrs_driver.protocol.framing import Frame, Framer, FramingCounters
from bahrs_driver.protocol.message import Message

SAMPLE_SIZE = 256       # bytes kept, to identify the device that sends a stream without frames
NO_INSTANT = Instant(0, 0)


@dataclass
class PipelineCounters:
    """Counts over all streams of a pipeline. Any thread may read them."""

    framing: FramingCounters
    streams: int = 0
    bytes_received: int = 0
    last_bytes: bytes = field(default=b'', repr=False)      # the latest SAMPLE_SIZE bytes


class Pipeline:
    """
    Frames, decodes and stamps the messages of one stream after another.

    Messages and their order do not depend on the size of the chunks. Only one thread may use it.
    """

    def __init__(self, framer: Framer, decoder: Decoder, clock: Clock | None = None) -> None:
        """Combine the parts of a device; messages stay unstamped without a clock."""
        self.counters = PipelineCounters(framer.counters)
        self._framer = framer
        self._decoder = decoder
        self._clock = clock or Unstamped()
        self._byte_time_ns = 0
        self._now = NO_INSTANT

    @property
    def received(self) -> int:
        """Offset of the next byte: the count of all bytes that were fed."""
        return self._framer.received

    def open(self, byte_time_ns: int = 0) -> None:      # noqa: A003, the usual name
        """Begin a stream on a line that carries a byte in byte_time_ns; 0 if that is unknown."""
        self.counters.streams += 1
        self._framer.flush()                # the previous stream may not have been closed
        self._byte_time_ns = byte_time_ns
        self._clock.begin(byte_time_ns)
        self._decoder.open(byte_time_ns)

    def feed(self, data: bytes, instant: Instant = NO_INSTANT) -> Sequence[Event]:
        """
        Return the events of a read: faults, notices, then the completed messages in stream order.

        instant is when all bytes had arrived; only a clock uses it. An exception of the decoder is
        an event. Any other exception discards the messages that wait for a stamp; the pipeline
        remains usable.
        """
        counters = self.counters
        counters.bytes_received += len(data)
        counters.last_bytes = (counters.last_bytes + data)[-SAMPLE_SIZE:]
        self._now = instant
        return self._stamp(self._framer.feed(data, self._decoder.expected()))

    def close(self) -> Sequence[Event]:
        """End the stream; return the events of its incomplete end and the messages held."""
        try:
            return self._stamp(self._framer.flush(), final=True)
        finally:
            self._decoder.close()

    def _stamp(self, frames: Sequence[Frame], final: bool = False) -> Sequence[Event]:
        messages, faults = self._decode(frames)
        clock = self._clock
        try:
            if not final:
                clock.observe_read(self._now, self._framer.received)
            stamped = clock.stamp(messages)
            if final:
                stamped += clock.end()
            stamped = self._decoder.resolve(stamped)
            notices = clock.take_notices()
        except Exception:
            clock.begin(self._byte_time_ns)     # a held message may have caused the exception
            raise
        if faults or notices:
            return [*faults, *map(Notice, notices), *stamped]
        return stamped

    def _decode(self, frames: Sequence[Frame]) -> tuple[
            list[tuple[Message, Frame]], list[DecodingFault]]:
        decode, now = self._decoder.decode, self._now.raw_ns
        messages: list[tuple[Message, Frame]] = []
        faults: list[DecodingFault] = []
        for frame in frames:
            try:
                message = decode(frame, now)
            except Exception as error:
                faults.append(DecodingFault(frame, error))
            else:
                if message is not None:
                    messages.append((message, frame))
        return messages, faults
