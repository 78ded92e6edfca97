# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Print the processor time in s that Python needs to touch each frame of a recording.

It cuts the bytes at known places, computes a zlib CRC of each frame and unpacks a struct. Measured
on the first megabytes of the file, and computed for all of it.
"""

from pathlib import Path
import struct
import sys
import zlib

from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.framing import Framer
from throughput import best_cpu_time

MEASURED = 10_000_000   # bytes
PAYLOAD = struct.Struct('<B6h')


def touch(data: bytes, places: list[slice]) -> None:
    """Do the least that is done for each frame."""
    for place in places:
        frame = data[place]
        zlib.crc32(frame)
        PAYLOAD.unpack_from(frame, 5)


def main() -> None:
    """Measure and print."""
    path = Path(sys.argv[1])
    with path.open('rb') as file:
        data = file.read(MEASURED)
    places = [slice(frame.offset, frame.end) for frame in Framer(BahrsFormat()).feed(data)]
    cost = best_cpu_time(lambda: touch(data, places))
    print(cost * path.stat().st_size / len(data))


if __name__ == '__main__':
    main()
