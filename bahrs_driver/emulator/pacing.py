# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""When each byte of a recorded stream is due, told from the rates of the device."""

from collections.abc import Iterator

from bahrs_driver.protocol.bahrs import Inertial, Navigation
from bahrs_driver.protocol.bahrs_frames import BahrsFormat
from bahrs_driver.protocol.framing import Frame, Framer

# Seconds from one message of a type to the next.
PERIODS = {Inertial.TYPE: 0.005, Navigation.TYPE: 0.01}
_TYPE_POSITION = 4


def paced(data: bytes) -> Iterator[tuple[float, bytes]]:
    """
    Cut a BAHRS stream into pieces that are due together, with the time of each in seconds.

    The most frequent message that the stream has tells the time; nothing is left out, and what
    is no frame goes with the frame that follows it.
    """
    framer = Framer(BahrsFormat())
    frames = framer.feed(data) + framer.flush()
    ticker = min((_type(frame) for frame in frames if _type(frame) in PERIODS),
                 key=lambda kind: PERIODS[kind], default=None)
    ticks, start = 0, 0
    for frame in frames:
        if _type(frame) == ticker:
            if frame.offset > start:
                yield ticks * PERIODS[ticker], data[start:frame.offset]
                start = frame.offset
            ticks += 1
    yield ticks * PERIODS.get(ticker or 0, 0.0), data[start:]


def _type(frame: Frame) -> int:
    return frame.data[_TYPE_POSITION]
