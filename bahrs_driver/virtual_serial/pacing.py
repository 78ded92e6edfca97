# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Schedule the bytes of a recorded stream by the message rates of the device."""

from collections.abc import Callable, Iterable, Iterator
from itertools import chain

from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults

Piece = tuple[float, bytes]     # s since the beginning, and the bytes due then
FramePeriod = Callable[[Frame], float | None]       # s between frames of this type, if regular


def pace(chunks: Iterable[bytes], framer: Framer, period_of: FramePeriod) -> Iterator[Piece]:
    """
    Cut a stream into pieces that are due together, with the time of each in seconds.

    The pace is the shortest period of the frames in the first chunk with periodic frames. Bytes
    between frames are due with the frame that follows.
    """
    buffer = bytearray()
    period, ticks, start = None, 0, 0
    for chunk in chain(chunks, [None]):
        buffer += chunk or b''
        frames = framer.flush() if chunk is None else framer.feed(chunk)
        period = period or _shortest_period(frames, period_of)
        for frame in frames:
            if period and period_of(frame) == period:
                if frame.offset > start:
                    yield ticks * period, bytes(buffer[:frame.offset - start])
                    del buffer[:frame.offset - start]
                    start = frame.offset
                ticks += 1
    yield ticks * (period or 0.0), bytes(buffer)


def transmit(pieces: Iterable[Piece], cable: Cable, faults: Faults,
             framer: Framer) -> Iterator[Piece]:
    """Return the pieces as they arrive over a faulty cable; faults apply to whole frames."""
    for due, data in chain(_cut_after_frames(pieces, framer), [(float('inf'), b'')]):
        while (arrival := cable.next_time) < due:
            yield arrival, cable.take(arrival)
        if data:
            cable.send(due, faults.apply(data))


def _cut_after_frames(pieces: Iterable[Piece], framer: Framer) -> Iterator[Piece]:
    """Cut pieces at the end of each frame; a frame is due with its last byte."""
    buffer, start, due = bytearray(), 0, 0.0
    for due, data in pieces:
        buffer += data
        for frame in framer.feed(data):
            yield due, bytes(buffer[:frame.end - start])
            del buffer[:frame.end - start]
            start = frame.end
    yield due, bytes(buffer)


def _shortest_period(frames: list[Frame], period_of: FramePeriod) -> float | None:
    return min((period for frame in frames if (period := period_of(frame))), default=None)
