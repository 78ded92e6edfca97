# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read the recorded bytes of a device.

A file of bare bytes has no times; a bag with the topic `raw` has the host's time of every read.
Both are read in pieces: a long recording needs no more memory than a short one.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from bahrs_driver.errors import CaptureError
from bahrs_driver.process.printable import printable

PIECE = 65536           # bytes in a chunk of a file without times


class Chunk(NamedTuple):
    """The bytes of one read."""

    data: bytes
    ros_ns: int | None = None       # host ROS time of the read, in ns since the epoch
    raw_ns: int | None = None       # the same time on CLOCK_MONOTONIC_RAW, if recorded
    connection_id: int = 1          # each connection begins a new stream


class Capture:
    """
    The recorded bytes of a device. Each call of `chunks()` reads from the beginning.

    `size` is the number of bytes on the disk, of which chunks() has read `done`. `sensor` and
    `byte_ns` (the transmission time of a byte, 0 for a line without a rate) are None if they are
    not recorded. `notes` has a sentence for each defect of the recording.
    """

    sensor: str | None = None
    byte_ns: int | None = None
    timed = False                   # whether chunks have the times of reads

    def __init__(self, path: Path, size: int) -> None:
        self.path = path
        self.size = size
        self.done = 0
        self.notes: list[str] = []

    def chunks(self) -> Iterator[Chunk]:
        """Yield all bytes in order; CaptureError if they cannot be read."""
        raise NotImplementedError


class ByteFile(Capture):
    """A file of bare bytes."""

    def chunks(self) -> Iterator[Chunk]:
        """Yield all bytes in order; CaptureError if they cannot be read."""
        self.done = 0
        try:
            with self.path.open('rb') as file:
                while data := file.read(PIECE):
                    self.done += len(data)
                    yield Chunk(data)
        except OSError as error:
            raise CaptureError(
                f'cannot read {printable(self.path)}: {error.strerror}') from error
