# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Framing of long blocks with numpy, thousands of frames at a time.

The frames are those that `Framer` finds, because only the obvious case is treated here: frames
that follow each other without a gap while the framer has no pending bytes, whose type has one
size, and whose checksum is the one that the framer tries first. A framer gets all other bytes,
until it has no pending bytes again.

A checksum is linear: it is the XOR of a constant and a number for each two bytes of the frame,
which depends on their value and place. So a few table lookups check all frames of one size.
"""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

from bahrs_driver.protocol.block_format import BlockFormat, Checksum
from bahrs_driver.protocol.framing import Frame, Framer
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

CHECKSUM_SIZE = 4       # bytes


class FrameBlock(NamedTuple):
    """Frames with the same header: offsets in the stream, and their bytes as rows."""

    header: bytes
    offsets: Array
    rows: Array


class _Candidates(NamedTuple):
    """The intact frames in a block, in the order of their beginnings."""

    starts: Array           # in the block
    ends: Array
    headers: Array          # index in the list of headers
    rows: Array             # index in the rows of their size
    rows_by_size: Mapping[int, Array]       # frames as elements, which are copied as a whole


class BlockFramer:
    """Splits a stream into intact frames, by blocks of any size."""

    def __init__(self, frame_format: BlockFormat) -> None:
        """Find the frames that a `Framer` with this format finds."""
        self.framer = Framer(frame_format)
        self._format = frame_format
        sizes = sorted((_key(header), size, header)
                       for header, size in frame_format.single_sizes.items())
        self._keys = np.array([key for key, _, _ in sizes], np.int64)
        self._sizes = np.array([size for _, size, _ in sizes], np.int64)
        self._headers = [header for _, _, header in sizes]
        assert frame_format.header_size < 8 <= self._sizes.min()

    def feed(self, block: bytes) -> Iterator[FrameBlock | list[Frame]]:
        """Yield the frames that a block completes; those of a run are in order of headers."""
        framer, position = self.framer, 0
        checksum = self._format.first_checksum
        found = self._find(block, checksum)
        chain_ends = _chain_ends(found)
        while position < len(block):
            index = int(np.searchsorted(found.starts, position))
            if framer.pending or index == len(found.starts) or found.starts[index] > position \
                    or self._format.first_checksum is not checksum:
                end = int(found.ends[index]) if index < len(found.ends) else len(block)
                yield framer.feed(block[position:end])
            else:
                after = int(chain_ends[index])
                yield from self._blocks(found, slice(index, after), framer.received - position)
                end = int(found.ends[after - 1])
                framer.skip_frames(after - index, end - position)
                self._format.passing_checksum(block[found.starts[after - 1]:end], None)
            position = end

    def flush(self) -> list[Frame]:
        """End the stream, and return the frames inside an incomplete candidate."""
        return self.framer.flush()

    def _find(self, block: bytes, checksum: Checksum) -> _Candidates:
        """Return all intact frames, even those inside others."""
        data = np.frombuffer(block, np.uint8)
        starts, headers = self._find_headers(data)
        sizes = self._sizes[headers]
        rows, intact, rows_by_size = np.zeros(len(starts), np.int64), sizes < 0, {}
        for size in np.unique(sizes):
            chosen = np.flatnonzero((sizes == size) & (starts + size <= len(data)))
            if not len(chosen):
                continue
            frames = _windows(data, f'V{size}')[starts[chosen]]
            rows_by_size[int(size)] = frames
            rows[chosen] = np.arange(len(chosen))
            intact[chosen] = _passes(_as_bytes(frames), checksum)
        return _Candidates(starts[intact], (starts + sizes)[intact], headers[intact],
                           rows[intact], rows_by_size)

    def _find_headers(self, data: Array) -> tuple[Array, Array]:
        """Return where known headers begin, and which ones they are."""
        words = _windows(data, '<i8')           # there is no shorter frame
        starts = np.flatnonzero(data[:len(words)] == self._format.marker[0])
        keys = words[starts] & (256 ** self._format.header_size - 1)
        headers = np.searchsorted(self._keys, keys).clip(max=len(self._keys) - 1)
        known = self._keys[headers] == keys
        return starts[known], headers[known]

    def _blocks(self, found: _Candidates, chain: slice, origin: int) -> Iterator[FrameBlock]:
        """Yield the frames of a chain by header; origin is the offset of the block."""
        headers, starts, rows = found.headers[chain], found.starts[chain], found.rows[chain]
        for header in np.unique(headers):
            chosen = headers == header
            frames = found.rows_by_size[int(self._sizes[header])][rows[chosen]]
            yield FrameBlock(self._headers[header], starts[chosen] + origin, _as_bytes(frames))


def _windows(data: Array, kind: str) -> Array:
    """Return the elements of a type that begin at each byte of data."""
    item = np.dtype(kind)
    return np.ndarray((max(0, len(data) - item.itemsize + 1),), item, data, 0, (1,))


def _as_bytes(frames: Array) -> Array:
    """Return frames of one size as rows of bytes."""
    return frames.view(np.uint8).reshape(len(frames), -1)


def _chain_ends(found: _Candidates) -> Array:
    """Return for each frame the index after the frames that follow it without a gap."""
    breaks = np.append(np.flatnonzero(found.ends[:-1] != found.starts[1:]), len(found.ends) - 1)
    return np.asarray(breaks[np.searchsorted(breaks, np.arange(len(found.ends)))] + 1)


def _key(header: bytes) -> int:
    return int.from_bytes(header, 'little')


def _passes(rows: Array, checksum: Checksum) -> Array:
    """Return whether the checksum of each row is right."""
    constant, tables = _tables(checksum, rows.shape[1] - CHECKSUM_SIZE)
    words = np.ascontiguousarray(rows[:, :-CHECKSUM_SIZE].view('<u2').T)
    computed = np.full(len(rows), constant, np.uint32)
    for table, word in zip(tables, words):
        computed ^= np.take(table, word)
    return np.asarray(computed == np.ascontiguousarray(
        rows[:, -CHECKSUM_SIZE:]).view('<u4')[:, 0])


@lru_cache(maxsize=64)
def _tables(checksum: Checksum, size: int) -> tuple[int, list[Array]]:
    """Return the checksum of zeros, and what each value of each two bytes changes in it."""
    zeros = bytes(size)
    constant = int.from_bytes(checksum(zeros), 'little')
    by_bit = np.array([[
        int.from_bytes(checksum(zeros[:place] + bytes([1 << bit]) + zeros[place + 1:]), 'little')
        ^ constant for bit in range(8)] for place in range(size)], np.uint32)
    changes = np.zeros((size, 256), np.uint32)
    for bit, change in enumerate(by_bit.T):
        changes ^= np.where(np.arange(256) >> bit & 1, change[:, None], 0).astype(np.uint32)
    low, high = changes[::2], changes[1::2]
    return constant, [(second[:, None] ^ first[None, :]).reshape(-1)
                      for first, second in zip(low, high)]
