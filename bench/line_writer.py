# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A process that writes inertial frames to a pseudo-terminal, at exactly the rate of a full line.

The emulator sends at the rates of a device, which do not fill the line; these frames are made in
advance. Force x and y hold the number of the frame. A device does not wait: bytes that the
pseudo-terminal does not accept wait in a buffer as large as that of a serial port in Linux, and
when that is full, frames are dropped and counted.
"""

import argparse
import json
import sys
import time

from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import FORCE, Inertial
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.units import BITS_PER_BYTE, COUNTER_MODULUS
from bahrs_driver.virtual_serial.pty_port import PtyPort

PERIOD = 0.001              # s from write to write, as of an adapter with its timer at 1 ms
BUFFER = 640 * 1024         # bytes that Linux keeps for a serial port until it drops some
LARGEST = 30_000            # value of force x; y counts on
SAFE = (Integrity.SAFE,) * 6


def frame(codec: BahrsCodec, number: int) -> bytes:
    """Return the frame of a sample."""
    high, low = divmod(number, LARGEST)
    return codec.encode(Inertial(number % COUNTER_MODULUS, (FORCE * low, FORCE * high, 0.0),
                                 (0.0, 0.0, 0.0), SAFE), version=3)


def number_of(force_x: float, force_y: float) -> int:
    """Return the number of a sample."""
    return round(abs(force_y) / FORCE) * LARGEST + round(force_x / FORCE)


class Line:
    """The line, and the buffer behind it."""

    def __init__(self, port: PtyPort, data: bytes, frame_size: int) -> None:
        self.dropped = 0            # frames
        self.most_waiting = 0       # bytes
        self._port = port
        self._data = data
        self._frame_size = frame_size
        self._next = 0              # index of the next byte to write

    def write_up_to(self, index: int) -> int:
        """Write the bytes before an index that the port accepts; return how many wait."""
        self._next += self._port.write_nowait(self._data[self._next:index])
        waiting = index - self._next
        self.most_waiting = max(self.most_waiting, min(waiting, BUFFER))
        if waiting > BUFFER:
            lost = (waiting - BUFFER) // self._frame_size
            self.dropped += lost
            self._next += lost * self._frame_size
        return waiting


def write(port: PtyPort, data: bytes, frame_size: int, bytes_per_second: float) -> dict[str, int]:
    """Write data at a rate; return what happened."""
    line, start, latest, longest = Line(port, data, frame_size), time.monotonic(), 0.0, 0.0
    index = 0
    while index < len(data):
        time.sleep(PERIOD)
        elapsed = time.monotonic() - start
        index = min(len(data), int(elapsed * bytes_per_second))
        line.write_up_to(index)
        longest, latest = max(longest, elapsed - latest), elapsed
    while line.write_up_to(len(data)):
        time.sleep(PERIOD)
    return {'sent': len(data) // frame_size - line.dropped, 'dropped': line.dropped,
            'most_waiting': line.most_waiting, 'longest_pause_ms': round(1e3 * longest)}


def main() -> None:
    """Print the port, wait for a line of input, write, and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--baud-rate', type=int, required=True)
    parser.add_argument('--duration', type=float, required=True, help='seconds')
    options = parser.parse_args()
    codec, bytes_per_second = BahrsCodec(), options.baud_rate / BITS_PER_BYTE
    size = len(frame(codec, 0))
    count = int(options.duration * bytes_per_second) // size
    data = b''.join(frame(codec, number) for number in range(count))
    with PtyPort() as port:
        print(port.path, flush=True)
        sys.stdin.readline()
        print(json.dumps(write(port, data, size, bytes_per_second)), flush=True)
        sys.stdin.readline()


if __name__ == '__main__':
    main()
