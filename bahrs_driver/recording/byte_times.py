# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Times for bytes that were kept without any: those that the device tells.

Each time message says what the device's clock was when it was sent. The bytes up to it are taken
as read shortly after that, and samples get their device time, from a start that the user names.
A device that was restarted goes on where it ended. A stream without time messages is taken to
have come at the full rate of the line.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from bahrs_driver.clock import byte_time_ns
from bahrs_driver.clock.smoother import Line, SmoothedLines
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.recording.capture import Capture, Chunk

READ_DELAY = 20_000_000         # ns; more than a time message may be away from its sample
RESTART = -1_000_000_000        # ns by which a clock must go back to have been set anew
AFTER_RESTART = 1_000_000_000   # ns that a restart is taken to last
LONGEST_TIME = 2 ** 62          # ns; beyond it a time is a mistake
MICROSECOND = 1000
LINE_RATE = 115200


class Anchor(NamedTuple):
    """The end of a time message in the stream, and its time in ns, in one sequence."""

    end: int
    time: int


class DeviceTimed(Capture):
    """A capture without times, with those of the device."""

    timed = True
    byte_ns = 0

    def __init__(self, capture: Capture, framer: Framer, codec: Any, start_ns: int | None,
                 progress: Callable[[str], None]) -> None:
        """Take the parts that find time messages; start_ns is the ROS time of the first."""
        super().__init__(capture.path, capture.size)
        self._inner = capture
        self._anchors: list[Anchor] = []
        self._offsets: list[tuple[int, int]] = []       # of each epoch: a time, and what to add
        time = None
        for frame in _frames(capture, framer, progress):
            told = getattr(codec.decode(frame), 'device_time_us', 0) * MICROSECOND
            if 0 < told < LONGEST_TIME:
                time = self._add(frame, told, time, start_ns)
        if not self._anchors:
            self._anchors.append(Anchor(framer.received, (
                start_ns or 0) + framer.received * byte_time_ns(LINE_RATE)))

    def lines(self) -> SmoothedLines:
        """Return how device time goes with the time of the chunks, exactly."""
        return SmoothedLines(Line(time, [(time, offset, 0.0)]) for time, offset in self._offsets)

    def chunks(self) -> Iterator[Chunk]:
        """Return all bytes, cut behind each time message."""
        buffer, place = bytearray(), 0
        anchors = iter(self._anchors)
        anchor = next(anchors)
        for piece in self._inner.chunks():
            self.done = self._inner.done
            buffer += piece.data
            while anchor and place + len(buffer) >= anchor.end:
                length = anchor.end - place
                yield Chunk(bytes(buffer[:length]), anchor.time + READ_DELAY)
                del buffer[:length]
                place, last = anchor.end, anchor
                anchor = next(anchors, Anchor(2 ** 63, last.time + AFTER_RESTART))
        if buffer:
            yield Chunk(bytes(buffer), anchor.time + READ_DELAY)

    def _add(self, frame: Frame, told: int, before: int | None, start_ns: int | None) -> int:
        if before is None:
            self._offsets.append((told, 0 if start_ns is None else start_ns - told))
        elif told - before < RESTART:
            last = self._anchors[-1].time
            self._offsets.append((told, last + AFTER_RESTART - told))
        elif told < before:
            told = before       # of an earlier sample, as navigation time may be
        self._anchors.append(Anchor(frame.end, told + self._offsets[-1][1]))
        return told


def _frames(capture: Capture, framer: Framer,
            progress: Callable[[str], None]) -> Iterator[Frame]:
    for chunk in capture.chunks():
        progress('looking for times')
        yield from framer.feed(chunk.data)
    yield from framer.flush()
