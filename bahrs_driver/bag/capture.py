# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The bytes that a device sent, from wherever they were kept.

A file of bare bytes has no times; a bag that holds `raw` has the host's time of every read. Both
are read a piece at a time, so that a long recording needs no more memory than a short one.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from bahrs_driver.errors import CaptureError
from bahrs_driver.process.printable import printable

PIECE = 65536           # bytes of a file without times that come at once


class Chunk(NamedTuple):
    """Bytes that came together."""

    data: bytes
    read_at: int | None = None      # host ROS time of the read, in ns since the epoch
    raw_at: int | None = None       # the same moment on CLOCK_MONOTONIC_RAW, if it was kept
    opening: int = 1                # of the port; another one begins another stream


class Capture:
    """
    What a device sent. `chunks()` may be called again, and begins at the beginning each time.

    `size` is what there is to read, in bytes on the disk, and `done` how much of it chunks() has
    behind it. `sensor` and `byte_ns` (the time of a byte on the line, 0 without a rate) are None
    if nothing tells. `notes` has a sentence for each thing that was wrong with the recording.
    """

    sensor: str | None = None
    byte_ns: int | None = None
    timed = False                   # whether chunks have the time of their read

    def __init__(self, path: Path, size: int) -> None:
        """Take where it is and how large it is, in bytes on the disk."""
        self.path = path
        self.size = size
        self.done = 0
        self.notes: list[str] = []

    def chunks(self) -> Iterator[Chunk]:
        """Return all bytes in order; CaptureError if they cannot be read."""
        raise NotImplementedError


class ByteFile(Capture):
    """A file of bytes as the device sent them."""

    def chunks(self) -> Iterator[Chunk]:
        """Return all bytes in order; CaptureError if they cannot be read."""
        self.done = 0
        try:
            with self.path.open('rb') as file:
                while data := file.read(PIECE):
                    self.done += len(data)
                    yield Chunk(data)
        except OSError as error:
            raise CaptureError(
                f'cannot read {printable(self.path)}: {error.strerror}') from error
