# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A file that is complete after each flush.

Most readers refuse an MCAP file without its end, and a recorder that is killed, or whose machine
loses power, writes no end. So each flush writes the pending bytes and a trailer, in one call; the
next flush overwrites that trailer. If the disk is full, the pending bytes are dropped, and the
file ends where it ended before.
"""

import contextlib
import os
from pathlib import Path

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import check_target, sentence


class CrashSafeFile:
    """A file to append to, with the methods that a writer of streams needs."""

    def __init__(self, path: Path, trailer: bytes) -> None:
        """
        Create the file, which the trailer completes; OSError if it cannot be created.

        It has a hidden name, which is not one of a bag, until the first flush.
        """
        self._path = path
        self._hidden: Path | None = path.with_name(f'.{path.name}.partial')
        self._trailer = trailer
        self._pending = bytearray()
        self._written = 0               # bytes before the trailer
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self._file = os.open(self._hidden, flags, 0o666)

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
        return self._written + len(self._pending)

    def flush(self) -> None:
        """Write all bytes and the trailer; after a WriteError the file is as before."""
        self._write_pending(self._trailer)

    def sync(self) -> None:
        """Make flushed bytes survive a loss of power."""
        os.fdatasync(self._file)

    def finish(self) -> None:
        """Write all bytes, which need no trailer, and close; WriteError as in flush."""
        try:
            self._write_pending(b'')
            self.sync()
        finally:
            self.close()

    def close(self) -> None:
        """Close the file as it is; a second call does nothing."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _write_pending(self, trailer: bytes) -> None:
        data, self._pending = bytes(self._pending), bytearray()
        try:
            _write(self._file, data + trailer, self._written)
            if self._hidden:
                check_target(str(self._path), self._path, replace=False)
                self._hidden.replace(self._path)
                self._hidden = None
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._written)
                _write(self._file, self._trailer, self._written)
            raise WriteError(sentence(error, self._path)) from error
        self._written += len(data)


def _write(file: int, data: bytes, offset: int) -> None:
    while data:
        count = os.pwrite(file, data, offset)
        data, offset = data[count:], offset + count
