# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Times for bytes that were kept without any: those that the device tells.

Samples get their device time, from a start that the user names. A device that was restarted goes
on where it ended. A chunk is taken as read shortly after its last sample.
"""

from array import array
from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.play_capture import play_capture
from bahrs_driver.clock.time_reference import Label
from bahrs_driver.pipeline import Pipeline, Stamped
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.reprocess.byte_clock import ByteClock
from bahrs_driver.reprocess.counted_stream import CountedStream
from bahrs_driver.units import NS_PER_MS

READ_DELAY = 20 * NS_PER_MS     # more than any message is behind its sample
SAMPLES = 20                    # a chunk
LONG_GAP = 60                   # samples that are missing


class DeviceTimed(Capture):
    """A capture without times, with those of the device."""

    timed = True
    byte_ns = 0

    def __init__(self, capture: Capture, make_pipeline: Callable[[], Pipeline],
                 label: Label, start_ns: int | None, progress: Callable[[str], None]) -> None:
        """
        Look at all messages.

        label says which sample time messages name, start_ns is the ROS time of the first one.
        """
        super().__init__(capture.path, capture.size)
        self._inner = capture
        for kind in (Inertial, Navigation):
            self._stream = CountedStream(label, kind)
            # Of each chunk where it ends, and the count of its last sample.
            self._ends, self._counts = array('q'), array('q')
            for played in play_capture(capture, make_pipeline(), LogClock()):
                progress('looking for times')
                for event in played.events:
                    if isinstance(event, Stamped):
                        self._take(event.frame, event.message)
            if self._stream.before:
                break
        self._stream.finish(start_ns)

    def clock(self, fixed_latency: int) -> ByteClock:
        """Return a clock that stamps the messages, with what it subtracts, in ns."""
        return ByteClock(self._stream, fixed_latency)

    def chunks(self) -> Iterator[Chunk]:
        """Return all bytes, cut before samples."""
        buffer, place, times = bytearray(), 0, self._stream.times
        cuts = chain(zip(self._ends, self._counts), [(2 ** 63, self._stream.count)])
        end, count = next(cuts)
        for piece in self._inner.chunks():
            self.done = self._inner.done
            buffer += piece.data
            while place + len(buffer) >= end:
                length = end - place
                yield Chunk(bytes(buffer[:length]), times.ros_time(count) + READ_DELAY)
                del buffer[:length]
                place = end
                end, count = next(cuts)
        if buffer:
            yield Chunk(bytes(buffer), times.ros_time(count) + READ_DELAY)

    def _take(self, frame: Frame, message: Any) -> None:
        stream = self._stream
        before = stream.count
        stream.take(message)
        if type(message) is stream.kind and (
                stream.count - before > LONG_GAP or before % SAMPLES < stream.step):
            self._ends.append(frame.offset)
            self._counts.append(before)
