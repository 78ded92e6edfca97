# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Decompress data from a file, up to a limit.

A few kilobytes can claim to be, or expand to, gigabytes. So data is decompressed a piece at a time
until the limit is reached.
"""

from collections.abc import Callable, Iterator
import io
from typing import BinaryIO

from bahrs_driver.bag.bag_kind import ZSTD_MAGIC
from bahrs_driver.errors import DamageError
import zstandard

PIECE = 1 << 20             # bytes decompressed at a time


def decompress(compression: str, data: bytes, limit: int) -> bytes:
    """Decompress data; DamageError if it is damaged, too large, or of an unknown compression."""
    if compression not in _DECOMPRESSORS:
        raise DamageError(f'compression {compression!r} is not supported')
    try:
        return _DECOMPRESSORS[compression](data, limit)
    except (RuntimeError, zstandard.ZstdError) as error:    # lz4 raises the first
        raise DamageError('it cannot be decompressed') from error


def decompress_message(data: bytes, limit: int) -> bytes:
    """Decompress a message if it is compressed: no other message begins with this magic."""
    return decompress('zstd', data, limit) if data.startswith(ZSTD_MAGIC) else data


def zstd_stream(file: BinaryIO) -> BinaryIO:
    """Return a stream of the decompressed file, which can be read and sought forward."""
    reader: BinaryIO = zstandard.ZstdDecompressor().stream_reader(
        file, read_across_frames=True, closefd=False)
    return reader


def zstd_pieces(file: BinaryIO, limit: int) -> Iterator[bytes]:
    """Yield the decompressed file; DamageError if it has more bytes than the limit."""
    stream = zstd_stream(file)
    return _pieces(lambda: stream.read(PIECE), limit)


def _zstd(data: bytes, limit: int) -> bytes:
    return b''.join(zstd_pieces(io.BytesIO(data), limit))


def _lz4(data: bytes, limit: int) -> bytes:
    from lz4.frame import LZ4FrameDecompressor
    decompressor, rest = LZ4FrameDecompressor(), data

    def read() -> bytes:
        nonlocal rest
        if decompressor.eof:
            return b''
        given, rest = rest, b''
        piece: bytes = decompressor.decompress(given, PIECE)
        return piece
    return b''.join(_pieces(read, limit))


def _pieces(read: Callable[[], bytes], limit: int) -> Iterator[bytes]:
    size = 0
    while piece := read():
        size += len(piece)
        if size > limit:
            raise DamageError(f'it expands to more than {limit:,} bytes')
        yield piece


_DECOMPRESSORS: dict[str, Callable[[bytes, int], bytes]] = {
    '': lambda data, _: data, 'zstd': _zstd, 'lz4': _lz4}
