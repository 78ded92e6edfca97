# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A file that is complete after each flush.

Most readers refuse an MCAP file without its end, and a recorder that is killed, or whose machine
loses power, writes no end. So each flush writes the pending bytes and an end, in one call; the
next flush begins where that end began. If the disk is full, the pending bytes are dropped, and the
file ends where it ended before.
"""

import contextlib
import os
from pathlib import Path

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import check_target, sentence


class SealedFile:
    """A file to append to, with the methods that a writer of streams needs."""

    def __init__(self, path: Path, end: bytes) -> None:
        """
        Create the file, which the bytes of end complete; OSError if it cannot be created.

        It gets its name with the first flush; the hidden name before is not one of a bag.
        """
        self._path = path
        self._hidden: Path | None = path.with_name(f'.{path.name}.partial')
        self._seal = end
        self._pending = bytearray()
        self._end_offset = 0             # offset at which the end begins
        how = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self._file = os.open(self._hidden, how, 0o666)

    def write(self, data: bytes) -> int:
        """Append bytes, which the next flush writes into the file."""
        self._pending += data
        return len(data)

    @property
    def pending(self) -> int:
        """Bytes that wait for the next flush."""
        return len(self._pending)

    def tell(self) -> int:
        """Return the offset of the next byte."""
        return self._end_offset + len(self._pending)

    def flush(self) -> None:
        """Write all bytes and the end; after a WriteError the file is as before."""
        self._put(self._seal)

    def sync(self) -> None:
        """Make flushed bytes survive a loss of power."""
        os.fdatasync(self._file)

    def finish(self) -> None:
        """Write all bytes, which include an end, and close; WriteError as in flush."""
        try:
            self._put(b'')
            self.sync()
        finally:
            self.close()

    def close(self) -> None:
        """Close the file as it is; a second call does nothing."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _put(self, end: bytes) -> None:
        data, self._pending = bytes(self._pending) + end, bytearray()
        try:
            _write(self._file, data, self._end_offset)
            if self._hidden:
                check_target(str(self._path), self._path, replace=False)
                self._hidden.replace(self._path)
                self._hidden = None
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._end_offset)
                _write(self._file, self._seal, self._end_offset)
            raise WriteError(sentence(error, self._path)) from error
        self._end_offset += len(data) - len(end)


def _write(file: int, data: bytes, offset: int) -> None:
    while data:
        count = os.pwrite(file, data, offset)
        data, offset = data[count:], offset + count
