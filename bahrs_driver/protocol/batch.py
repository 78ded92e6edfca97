# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Decoding of a whole recording into numpy arrays.

The rows of the codec's layouts convert the values here, too, so that both always agree. A field of
8 or 16 bits is looked up in a table of all its decoded values. Frames are collected by their
header. The messages of one kind are a structured array with

    offset      offset of the frame's first byte in the stream
    ...         the fields of the message, SI: vectors as (n, 3), health as (n, signals) with the
                numbers of Integrity, None as NaN, texts as objects
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from enum import IntEnum
from functools import lru_cache
from typing import Any

from bahrs_driver.protocol.block_framing import FrameBlock
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.layout import Layout
from bahrs_driver.protocol.row import Row
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

_PENDING = 65536        # frames collected before they are packed
_LOOKED_UP = 2          # size in bytes up to which a field is decoded with a table


class Batch:
    """Collects frames, and decodes all messages of a kind at once."""

    def __init__(self, layouts: Mapping[bytes, Layout[Any]]) -> None:
        """Map headers, which must have the same size, to layouts."""
        self._layouts = layouts
        (self._header_size,) = {len(header) for header in layouts}
        self._pending: dict[bytes, list[Frame]] = defaultdict(list)
        self._packed: dict[bytes, list[tuple[Array, bytes]]] = defaultdict(list)
        self._count = 0

    def add(self, frames: Iterable[Frame]) -> None:
        """Add the next frames of a stream."""
        for frame in frames:
            self._pending[frame.data[:self._header_size]].append(frame)
            self._count += 1
        if self._count >= _PENDING:
            self._pack()

    def add_block(self, block: FrameBlock) -> None:
        """Add frames with the same header."""
        payload = slice(self._header_size, self._header_size + self._layouts[block.header].size)
        self._packed[block.header].append((block.offsets, block.rows[:, payload].tobytes()))

    def counts(self) -> dict[bytes, int]:
        """Count the frames by header, in the order of the first ones."""
        self._pack()
        ordered = sorted(self._packed.items(),
                         key=lambda item: min(int(offsets[0]) for offsets, _ in item[1]))
        return {header: sum(len(offsets) for offsets, _ in parts) for header, parts in ordered}

    def take(self, message: type) -> Array:
        """Decode and remove all messages of a kind, of any version, in stream order."""
        self._pack()
        parts = [(header, *part) for header in list(self._packed)
                 if self._layouts[header].message is message
                 for part in self._packed.pop(header)]
        parts.sort(key=lambda part: part[1][0], reverse=True)
        size = sum(len(offsets) for _, offsets, _ in parts)
        kind = next(layout for layout in self._layouts.values() if layout.message is message)
        joined: Array = np.empty(size, table(kind, b'', np.empty(0, np.int64)).dtype)
        end = 0
        while parts:                    # the memory of each is freed when it is decoded
            header, offsets, payloads = parts.pop()
            begin, end = end, end + len(offsets)
            joined[begin:end] = table(self._layouts[header], payloads, offsets)
        if np.any(np.diff(joined['offset']) < 0):
            joined = joined[np.argsort(joined['offset'], kind='stable')]
        return joined

    def _pack(self) -> None:
        for header, frames in self._pending.items():
            size = self._layouts[header].size
            payload = slice(self._header_size, self._header_size + size)
            offsets = np.fromiter((frame.offset for frame in frames), np.int64, len(frames))
            self._packed[header].append(
                (offsets, b''.join([frame.data[payload] for frame in frames])))
        self._pending.clear()
        self._count = 0


def table(layout: Layout[Any], payloads: bytes, offsets: Array) -> Array:
    """Decode the concatenated payloads of one layout into a structured array."""
    raw = _raw(layout, payloads, len(offsets))
    columns = [(name, _column(row, raw[name])) for name, row in layout.rows]
    result = np.empty(len(offsets), [('offset', np.int64)] + [
        (name, column.dtype, column.shape[1:]) for name, column in columns])
    result['offset'] = offsets
    for name, column in columns:
        result[name] = column
    return result


def column(layout: Layout[Any], payloads: bytes, count: int, name: str) -> Array:
    """Decode one field of a count of concatenated payloads."""
    return _column(dict(layout.rows)[name], _raw(layout, payloads, count)[name])


def _raw(layout: Layout[Any], payloads: bytes, count: int) -> Array:
    """Return the numbers on the wire."""
    wire = _wire_type(layout)
    return np.frombuffer(payloads, wire, count) if layout.size else np.empty(count, wire)


def _wire_type(layout: Layout[Any]) -> np.dtype[Any]:
    """Return the type of a payload on the wire."""
    kinds: list[Any] = []
    offsets, offset = [], 0
    for _, row in layout.rows:
        kind = np.dtype(f'V{row.code[:-1]}' if row.code.endswith('s')
                        else layout.byte_order + row.code)
        kinds.append(kind if row.count == 1 else (kind, (row.count,)))
        offsets.append(offset)
        offset += kind.itemsize * row.count + row.reserved
    return np.dtype({'names': [name for name, _ in layout.rows], 'formats': kinds,
                     'offsets': offsets, 'itemsize': layout.size})


def _column(row: Row, raw: Array) -> Array:
    """Decode the values of a field."""
    if row.scale is not None:
        return np.asarray(raw * row.scale + row.offset)
    if row.decode is None:
        return np.asarray(raw, raw.dtype.newbyteorder('='))
    if row.code.endswith('s'):
        values: Array = np.empty(len(raw), object)
        values[:] = [row.decode(bytes(item)) for item in raw]
        return values
    if raw.dtype.itemsize <= _LOOKED_UP:
        found: Array = _every_value(row)[raw.astype(f'u{raw.dtype.itemsize}')]
        return found
    different, inverse = np.unique(raw, return_inverse=True)
    return np.asarray(_decoded(row, different)[inverse.reshape(raw.shape)])


@lru_cache(maxsize=256)
def _every_value(row: Row) -> Array:
    """Decode all values of a small field, indexed by their bits as an unsigned number."""
    kind = np.dtype(row.code)
    bits = np.arange(256 ** kind.itemsize, dtype=f'u{kind.itemsize}')
    return _decoded(row, bits.view(kind))


def _decoded(row: Row, values: Array) -> Array:
    """Decode values one by one."""
    assert row.decode
    found = [row.decode(item) for item in values.tolist()]
    sample = row.decode(0)
    if isinstance(sample, tuple):
        assert all(isinstance(part, IntEnum) for part in sample)
        return np.array(found, np.uint8).reshape(-1, len(sample))
    kind = bool if isinstance(sample, bool) else float
    return np.array([np.nan if item is None else item for item in found], kind)
