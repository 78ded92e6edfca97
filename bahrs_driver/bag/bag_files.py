# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find and open the files of a rosbag2 bag, in their order.

The first bytes of a file show its kind. A file that rosbag2 compressed as a whole is decompressed
while it is read, or into a temporary file for SQLite, which needs random access.
"""

from collections.abc import Iterator
import io
from pathlib import Path
import re
import tempfile
from typing import BinaryIO, cast

from bahrs_driver.bag.bag_kind import (
    base_name, COMPRESSIONS, HEAD_SIZE, KINDS, SQLITE_MAGIC, ZSTD_MAGIC,
)
from bahrs_driver.bag.compression import zstd_pieces, zstd_stream
from bahrs_driver.bag.damage import Damage
from bahrs_driver.bag.mcap_input import read_mcap
from bahrs_driver.bag.sqlite_input import read_sqlite
from bahrs_driver.bag.stored_message import StoredMessage
from bahrs_driver.errors import CaptureError, DamageError
from bahrs_driver.process.printable import printable

MAX_RATIO = 1000                # by which a compressed file may expand
MIN_LIMIT = 64 << 20            # bytes that any file may expand to


def find_files(path: Path) -> list[Path]:
    """Return the files of a bag in their order; CaptureError if there are none."""
    shown = printable(path)
    try:
        if path.is_file():
            return [path]
        names = list(path.iterdir())
    except OSError as error:
        raise CaptureError(f'cannot read {shown}: {error.strerror}') from error
    for kind in KINDS:
        # While a file is compressed both are there, and the compressed one may not be whole.
        found = {base_name(file): file for suffix in reversed(COMPRESSIONS) for file in names
                 if file.name.endswith(kind + suffix)}
        if found:
            return sorted(found.values(), key=_number)
    raise CaptureError(f'{shown} is not a bag: it has no .mcap and no .db3 file')


class BagFile:
    """One file of a bag. Each call of messages() reads it from the beginning."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.size = path.stat().st_size
        self.damage = Damage(path)
        self.done = 0                   # bytes read so far, approximately
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def messages(self) -> Iterator[StoredMessage]:
        """Yield the raw messages in their order, up to damage that ends the file."""
        self.damage, self.done = Damage(self.path), 0
        try:
            with self.path.open('rb') as file, self.damage.stop_if_damaged():
                yield from self._messages(file)
        except OSError as error:
            raise CaptureError(
                f'cannot read {printable(self.path)}: {error.strerror}') from error
        self.done = self.size

    def _messages(self, file: io.BufferedReader) -> Iterator[StoredMessage]:
        head = file.peek(HEAD_SIZE)
        if compressed := head.startswith(ZSTD_MAGIC):
            head = zstd_stream(file).read(HEAD_SIZE)
            file.seek(0)
        if head.startswith(SQLITE_MAGIC):
            database = self._decompress(file) if compressed else self.path
            for message, fraction in read_sqlite(database, self.damage):
                self.done = min(self.size, max(0, round(fraction * self.size)))
                yield message
            return
        stream = zstd_stream(file) if compressed else cast(BinaryIO, file)
        for message in read_mcap(stream, self.damage):
            self.done = file.tell()
            yield message

    def _decompress(self, file: BinaryIO) -> Path:
        """Decompress into a temporary file, which exists as long as this object."""
        if self._folder is None:
            folder = tempfile.TemporaryDirectory(prefix='bahrs_')
            try:
                with Path(folder.name, 'bag.db3').open('wb') as output:
                    output.writelines(zstd_pieces(file, max(MIN_LIMIT, MAX_RATIO * self.size)))
            except (OSError, DamageError) as error:
                folder.cleanup()
                raise CaptureError(
                    f'cannot decompress {printable(self.path)} into {folder.name}: {error}. '
                    'Decompress it with zstd -d and name the result') from error
            self._folder = folder
        return Path(self._folder.name) / 'bag.db3'


def _number(file: Path) -> tuple[int, str]:
    """Return a key that orders files by the number that a split gave them."""
    digits = re.search(r'_([0-9]+)$', base_name(file))
    return int(digits[1]) if digits else -1, file.name
