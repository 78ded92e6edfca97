# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Measure the processor time of a frame from bytes to ROS messages, in microseconds.

The floor is the minimum for Python: cut the bytes at known offsets, run zlib over each frame and
one struct over its payload. Each figure is the best of several runs, also as a multiple of the
floor, which is measured in the same run.
"""

from collections.abc import Callable
import contextlib
import io
import os
import struct
import time
import zlib

from bahrs_driver.cli.main import main as emulator
from bahrs_driver.clock import Clock, Instant, SampleClock
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Accuracy, Inertial, InertialTime, Navigation
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.batch import Batch
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.ros_layout.layouts import serialize
from bahrs_driver.units import NS_PER_S

SECONDS = 60            # of the device's stream
RUNS = 5
CHUNK = 62              # bytes that a USB adapter delivers at a time
BYTE_NS = 86_805        # at 115200 baud
SAFE = (Integrity.SAFE,) * 6
INERTIAL_PAYLOAD = struct.Struct('<B6hH')


def stream() -> list[bytes]:
    """Return the frames of a device of version 3, in order."""
    codec, frames = BahrsCodec(), []
    for index in range(200 * SECONDS):
        messages = [Inertial(index % 256, (0.1, 0.2, -9.8), (0.01, 0.02, 0.03), SAFE)]
        if index % 2 == 0:
            messages.append(
                Navigation(index // 2 % 256, 500.0, 0.1, 0.1, 0.2, 0.3, SAFE[:5]))
        if index % 20 == 0:
            messages.append(InertialTime(index // 20 % 256, index % 256, 5000 * index))
            messages.append(Accuracy(index // 20 % 256, 0.01, 0.01, 0.02, 5000 * index))
        frames += [codec.encode(message, 3) for message in messages]
    return frames


def best(work: Callable[[], object], frames: int) -> float:
    """Return the microseconds per frame of the fastest of several runs."""
    times = []
    for _ in range(RUNS):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times) / frames * 1e6


def main() -> None:
    """Measure and print a table."""
    pieces = stream()
    data = b''.join(pieces)
    bounds, position = [], 0
    for piece in pieces:
        bounds.append((position, position + len(piece)))
        position += len(piece)

    def floor() -> None:
        for start, end in bounds:
            piece = data[start:end]
            zlib.crc32(piece)
            if len(piece) == 28:
                INERTIAL_PAYLOAD.unpack_from(piece, 5)

    def framing(chunk: int = CHUNK) -> list:
        framer, found = Framer(BahrsFormat()), []
        for start in range(0, len(data), chunk):
            found += framer.feed(data[start:start + chunk])
        return found

    found, codec = framing(), BahrsCodec()
    assert len(found) == len(pieces)
    messages = [codec.decode(frame) for frame in found]
    parts = DEVICES['bahrs'].parts(BahrsSettings())

    def pipeline(clock: Clock | None = None) -> None:
        stamping = Pipeline(Framer(BahrsFormat()), BahrsCodec(), clock)
        stamping.open(BYTE_NS)
        for start in range(0, len(data), CHUNK):
            now = (start + CHUNK) * SECONDS * NS_PER_S // len(data)
            stamping.feed(data[start:start + CHUNK], Instant(now, now))

    def convert() -> None:
        for index, message in enumerate(messages):
            for _ in parts.converter.convert(message, index):
                pass

    def emulate() -> None:
        with contextlib.redirect_stderr(io.StringIO()):
            emulator(['emulate', '--output', os.devnull, '--duration', str(SECONDS)])

    count = len(pieces)
    base = best(floor, count)

    def batch() -> None:
        whole = Batch(codec.layouts_by_header)
        whole.add(found)
        for kind in (Inertial, Navigation, InertialTime, Accuracy):
            whole.take(kind)

    def blocks() -> None:
        framer, whole = BlockFramer(BahrsFormat()), Batch(codec.layouts_by_header)
        for block in framer.feed(data):
            (whole.add_block if isinstance(block, FrameBlock) else whole.add)(block)
        assert framer.framer.counters.frames == count
        for kind in (Inertial, Navigation, InertialTime, Accuracy):
            whole.take(kind)

    def convert_and_serialize() -> None:
        for index, message in enumerate(messages):
            for _, values in parts.converter.convert(message, index):
                serialize(values)

    rows = [
        ('floor', base),
        (f'framing, chunks of {CHUNK} bytes', best(framing, count)),
        ('framing, byte by byte', best(lambda: framing(1), count)),
        ('decoding', best(lambda: [codec.decode(frame) for frame in found], count)),
        ('pipeline, unstamped', best(pipeline, count)),
        ('pipeline, stamped', best(lambda: pipeline(SampleClock(ROLES)), count)),
        ('decoding all at once', best(batch, count)),
        ('framing and decoding blocks', best(blocks, count)),
        ('converting to values', best(convert, count)),
        ('converting and serializing', best(convert_and_serialize, count)),
        ('emulating the device', best(emulate, count)),
    ]
    rate = count / SECONDS
    print(f'{count:,} frames; a device sends {rate:.0f} per second')
    for name, cost in rows:
        print(f'{name:<32}{cost:8.2f} us per frame {cost / base:7.1f} x floor '
              f'{cost * rate / 1e4:6.2f} % of a core')


if __name__ == '__main__':
    main()
