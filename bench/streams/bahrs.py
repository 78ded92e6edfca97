# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print the rate of this package, on inertial, navigation and time messages of a BAHRS."""

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Inertial, InertialTime, Navigation
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
from throughput import chunks, mix, print_rate

SAFE = (Integrity.SAFE,) * 6
CODEC = BahrsCodec()


def inertial(index: int) -> bytes:
    """Return the inertial message of a sample."""
    x, y, z = (place + index / 100 for place in range(3))
    return CODEC.encode(Inertial(index, (x, y, -9.8 + z), (x, y, z), SAFE), 3)


def navigation(index: int) -> bytes:
    """Return the navigation message of a sample."""
    angle = index / 100
    return CODEC.encode(Navigation(index, 500 + angle, angle, angle, -angle, angle, SAFE[:5]), 3)


def clock(index: int) -> bytes:
    """Return the time message of a sample."""
    return CODEC.encode(InertialTime(index, index, 5000 * index), 3)


def count(data: bytes) -> int:
    """Return the count of intact messages."""
    framer, codec, found = Framer(BahrsFormat()), BahrsCodec(), 0
    for chunk in chunks(data):
        found += len([codec.decode(frame) for frame in framer.feed(chunk)])
    return found


if __name__ == '__main__':
    print_rate(count, mix(inertial, navigation, clock))
