# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""When each byte of a recorded stream is due: told from the rates of the device, or kept."""

from collections.abc import Iterable, Iterator
from itertools import chain

from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults

# Seconds from one message of a type to the next.
PERIODS = {Inertial.TYPE: 0.005, Navigation.TYPE: 0.01}
_TYPE_POSITION = 4

Piece = tuple[float, bytes]     # s since the beginning, and what is due then


def paced(chunks: Iterable[bytes]) -> Iterator[Piece]:
    """
    Cut a BAHRS stream into pieces that are due together, with the time of each in seconds.

    The most frequent message in its first chunk that has any tells the time; nothing is left
    out, and what is no frame goes with the frame that follows it.
    """
    framer, buffer = Framer(BahrsFormat()), bytearray()
    ticker, ticks, start = None, 0, 0
    for chunk in chain(chunks, [None]):
        buffer += chunk or b''
        frames = framer.flush() if chunk is None else framer.feed(chunk)
        ticker = ticker or _ticker(frames)
        for frame in frames:
            if ticker and _type(frame) == ticker:
                if frame.offset > start:
                    yield ticks * PERIODS[ticker], bytes(buffer[:frame.offset - start])
                    del buffer[:frame.offset - start]
                    start = frame.offset
                ticks += 1
    yield ticks * PERIODS.get(ticker or 0, 0.0), bytes(buffer)


def through(pieces: Iterable[Piece], cable: Cable, faults: Faults, framer: Framer
            ) -> Iterator[Piece]:
    """Return the pieces as they arrive over a bad cable; faults are put on whole frames."""
    for due, data in chain(_whole(pieces, framer), [(float('inf'), b'')]):
        while (arrival := cable.next_time) < due:
            yield arrival, cable.take(arrival)
        if data:
            cable.send(due, faults.apply(data))


def _whole(pieces: Iterable[Piece], framer: Framer) -> Iterator[Piece]:
    """Cut pieces anew, behind each frame, which is due with its last byte."""
    buffer, start, due = bytearray(), 0, 0.0
    for due, data in pieces:
        buffer += data
        for frame in framer.feed(data):
            yield due, bytes(buffer[:frame.end - start])
            del buffer[:frame.end - start]
            start = frame.end
    yield due, bytes(buffer)


def _ticker(frames: list[Frame]) -> int | None:
    kinds = [_type(frame) for frame in frames if _type(frame) in PERIODS]
    return min(kinds, key=PERIODS.__getitem__) if kinds else None


def _type(frame: Frame) -> int:
    return frame.data[_TYPE_POSITION]
