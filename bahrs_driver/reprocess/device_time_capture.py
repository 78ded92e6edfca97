# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read times for a capture that has none, from the device times in its messages.

Samples get their device time, starting at a time that the user gives. After a restart of the
device time continues. Each chunk counts as read shortly after its last sample.
"""

from array import array
from collections.abc import Callable, Iterable, Iterator
from itertools import chain

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.time_reference import Label
from bahrs_driver.devices.recording_format import RecordingFormat
from bahrs_driver.reprocess.counted_messages import CountedMessage, CountedMessages
from bahrs_driver.reprocess.device_time_clock import DeviceTimeClock
from bahrs_driver.reprocess.stream_counter import StreamCounter
from bahrs_driver.units import NS_PER_MS

READ_DELAY = 20 * NS_PER_MS     # longer than from a sample to any message about it
SAMPLES = 20                    # per chunk
LONG_GAP = 60                   # missing samples
END_OF_STREAM = 2 ** 63         # bytes


class DeviceTimeCapture(Capture):
    """A capture with read times computed from device time."""

    timed = True
    byte_ns = 0

    def __init__(self, capture: Capture, recording_format: RecordingFormat, label: Label,
                 start_ns: int | None, progress: Callable[[str], None]) -> None:
        """
        Examine all messages of a capture.

        label is the convention of time messages, start_ns the ROS time of the first one.
        """
        super().__init__(capture.path, capture.size)
        self._source, self._roles = capture, recording_format.roles
        roles = self._roles
        for kind in (roles.sample, roles.navigation):
            self._stream = StreamCounter(roles, kind, label)
            # Of each chunk: the offset of its end, and the count of its last sample.
            self._chunk_ends, self._chunk_counts = array('q'), array('q')
            # Of each sample whose count does not follow: its number, its count and its counter.
            self._jumps = array('q'), array('q'), array('B')
            self._received = 0          # samples
            messages = CountedMessages(recording_format)
            for chunk in capture.chunks():
                progress('looking for times')
                self._examine(messages.feed(chunk.data))
            self._examine(messages.flush())
            if self._stream.origin:
                break
        self._stream.assign_ros_times(start_ns)

    def clock(self, fixed_latency: int) -> DeviceTimeClock:
        """Return a clock for the messages that subtracts fixed_latency ns from each stamp."""
        jumps = ((number, CountedSequence(count, sequence))
                 for number, count, sequence in zip(*self._jumps))
        return DeviceTimeClock(self._roles, self._stream, jumps, fixed_latency)

    def chunks(self) -> Iterator[Chunk]:
        """Yield all bytes, cut before samples."""
        buffer, begin = bytearray(), 0          # bytes of the next chunk, and their offset
        chunks = chain(zip(self._chunk_ends, self._chunk_counts),
                       [(END_OF_STREAM, self._stream.count)])
        end, count = next(chunks)
        for piece in self._source.chunks():
            self.done = self._source.done
            buffer += piece.data
            while begin + len(buffer) >= end:
                length = end - begin
                yield self._chunk(buffer[:length], count)
                del buffer[:length]
                begin = end
                end, count = next(chunks)
        if buffer:
            yield self._chunk(buffer, count)

    def _chunk(self, data: bytearray, count: int) -> Chunk:
        return Chunk(bytes(data), self._stream.times.ros_time(count) + READ_DELAY)

    def _examine(self, messages: Iterable[CountedMessage]) -> None:
        stream = self._stream
        for offset, kind, message in messages:
            before = stream.count
            stream.observe(kind, message)
            if kind is stream.kind:
                self._add_sample(offset, before, message.sequence)

    def _add_sample(self, offset: int, before: int, sequence: int) -> None:
        stream = self._stream
        ahead = stream.count - before
        if ahead != stream.step:
            for column, value in zip(self._jumps, (self._received, stream.count, sequence)):
                column.append(value)
        self._received += 1
        if ahead > LONG_GAP or before % SAMPLES < stream.step:
            self._chunk_ends.append(offset)
            self._chunk_counts.append(before)
