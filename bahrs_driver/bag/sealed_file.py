# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A file that is whole whenever nobody is writing into it.

An MCAP file without its end is refused by most readers, and a recorder that is killed, or whose
machine loses power, writes no end. So each flush writes what has come and an end behind it, in
one call; the next flush begins where that end began. If there is no room left, what was to be
written is taken back, and the file ends where it ended before.
"""

import contextlib
import os
from pathlib import Path

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import check_target, sentence


class SealedFile:
    """A file to append to. It takes what a writer of streams needs: write, tell and flush."""

    def __init__(self, path: Path, end: bytes) -> None:
        """
        Make the file; end is what makes it whole. OSError if it cannot be made.

        It has its name from the first flush on, and before that one that nobody takes for a bag's.
        """
        self._path = path
        self._hidden: Path | None = path.with_name(f'.{path.name}.partial')
        self._seal = end
        self._pending = bytearray()
        self._place = 0             # where the end begins
        how = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self._file = os.open(self._hidden, how, 0o666)

    def write(self, data: bytes) -> int:
        """Take bytes; they are in the file after the next flush."""
        self._pending += data
        return len(data)

    @property
    def pending(self) -> int:
        """How many bytes wait for the next flush."""
        return len(self._pending)

    def tell(self) -> int:
        """Return where the next byte will be."""
        return self._place + len(self._pending)

    def flush(self) -> None:
        """Write all, and the end. WriteError if there is no room; the file is then as before."""
        self._put(self._seal)

    def sync(self) -> None:
        """Have what was flushed survive a loss of power."""
        os.fdatasync(self._file)

    def finish(self) -> None:
        """Write all, which has an end of its own, and close. WriteError as in flush."""
        try:
            self._put(b'')
            self.sync()
        finally:
            self.close()

    def close(self) -> None:
        """Close the file as it is; once it is, nothing happens."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _put(self, end: bytes) -> None:
        data, self._pending = bytes(self._pending) + end, bytearray()
        try:
            _write(self._file, data, self._place)
            if self._hidden:
                check_target(str(self._path), self._path, replace=False)
                self._hidden.replace(self._path)
                self._hidden = None
        except OSError as error:
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._place)
                _write(self._file, self._seal, self._place)
            raise WriteError(sentence(error, self._path)) from error
        self._place += len(data) - len(end)


def _write(file: int, data: bytes, place: int) -> None:
    while data:
        count = os.pwrite(file, data, place)
        data, place = data[count:], place + count
