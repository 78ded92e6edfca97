# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Decoding of a whole recording into numpy arrays.

The rows of the codec's layouts convert the values here, too, so that both always agree. A field of
8 or 16 bits is looked up in a table of all its decoded values. Frames are collected by their
header, and decoded many at a time, because each call of numpy takes as long as 1,000 values. The
messages of one kind become columns, arrays by name that have one element for each message:

    offset      offset of the frame's first byte in the stream
    ...         the fields of the message, SI: vectors as (n, 3), health as (n, signals) with the
                numbers of Integrity, None as NaN, texts as objects
"""

from collections import Counter, defaultdict
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
Columns = dict[str, Array]

_PENDING = 65536        # frames collected before they are decoded
_LOOKED_UP = 2          # size in bytes up to which a field is decoded with a table


class Batch:
    """Collects frames, and decodes many messages of a kind at once."""

    def __init__(self, layouts: Mapping[bytes, Layout[Any]], real: type = np.float64) -> None:
        """Map headers, which must have the same size, to layouts. Real numbers become `real`."""
        self._layouts = layouts
        self._real = real
        (self._header_size,) = {len(header) for header in layouts}
        self._first: dict[bytes, int] = {}          # offset of the first frame with a header
        self._counts = Counter[bytes]()
        # By header: offsets, and the first bytes of the frames, header and payload.
        self._pending: dict[bytes, list[tuple[Array, Array]]] = defaultdict(list)
        self._pending_count = 0
        self._decoded: dict[type, _GrowingColumns] = defaultdict(_GrowingColumns)

    def add(self, frames: Iterable[Frame]) -> None:
        """Add the next frames of a stream."""
        by_header: dict[bytes, list[Frame]] = defaultdict(list)
        for frame in frames:
            by_header[frame.data[:self._header_size]].append(frame)
        for header, found in by_header.items():
            size = self._size(header)
            offsets = np.fromiter((frame.offset for frame in found), np.int64, len(found))
            heads = b''.join([frame.data[:size] for frame in found])
            self._add(header, offsets, np.frombuffer(heads, f'V{size}'))

    def add_block(self, block: FrameBlock) -> None:
        """Add the next frames of a stream, which have the same header."""
        head = np.dtype({'names': ['head'], 'formats': [f'V{self._size(block.header)}'],
                         'itemsize': block.rows.shape[1]})
        self._add(block.header, block.offsets, block.rows.view(head)['head'][:, 0])

    def counts(self) -> dict[bytes, int]:
        """Count the frames by header, in the order of the first ones."""
        return {header: self._counts[header]
                for header in sorted(self._first, key=self._first.__getitem__)}

    def take(self, message: type) -> Columns:
        """Decode and remove all messages of a kind, of any version, in stream order."""
        self._decode_pending()
        decoded = self._decoded.pop(message, None)
        if decoded is None:
            kind = next(layout for layout in self._layouts.values() if layout.message is message)
            return table(kind, b'', np.empty(0, np.int64), self._real)
        columns = decoded.filled()
        offset = columns['offset']
        if np.any(offset[1:] < offset[:-1]):
            order = np.argsort(offset, kind='stable')
            columns = {name: column[order] for name, column in columns.items()}
        return columns

    def _size(self, header: bytes) -> int:
        """Return the size of header and payload."""
        return self._header_size + self._layouts[header].size

    def _add(self, header: bytes, offsets: Array, heads: Array) -> None:
        self._first.setdefault(header, int(offsets[0]))
        self._counts[header] += len(offsets)
        self._pending[header].append((offsets, heads))
        self._pending_count += len(offsets)
        if self._pending_count >= _PENDING:
            self._decode_pending()

    def _decode_pending(self) -> None:
        for header, parts in self._pending.items():
            layout = self._layouts[header]
            offsets, heads = (np.concatenate(column) for column in zip(*parts))
            raw = heads.view(_wire_type(layout, self._header_size))
            self._decoded[layout.message].append(_columns(layout, raw, offsets, self._real))
        self._pending.clear()
        self._pending_count = 0


class _GrowingColumns:
    """Columns to which messages are appended; one at a time is copied when they grow."""

    def __init__(self) -> None:
        self._columns: Columns = {}
        self._count = 0

    def append(self, columns: Columns) -> None:
        """Append messages."""
        begin, self._count = self._count, self._count + len(columns['offset'])
        for name, values in columns.items():
            column = self._columns.get(name, values)
            if self._count > len(column):
                # Memory that was not written yet costs nothing.
                grown = np.empty((2 * self._count, *column.shape[1:]), column.dtype)
                grown[:begin] = column[:begin]
                column = grown
            column[begin:self._count] = values
            self._columns[name] = column

    def filled(self) -> Columns:
        """Return the part of the columns that has messages."""
        return {name: column[:self._count] for name, column in self._columns.items()}


def table(layout: Layout[Any], payloads: bytes, offsets: Array, real: type = np.float64
          ) -> Columns:
    """Decode the concatenated payloads of one layout into columns."""
    wire = _wire_type(layout)
    raw = np.frombuffer(payloads, wire, len(offsets)) if layout.size \
        else np.empty(len(offsets), wire)
    return _columns(layout, raw, offsets, real)


def block_column(layout: Layout[Any], block: FrameBlock, name: str) -> Array:
    """Decode one field of the frames of a block."""
    wire = _wire_type(layout, len(block.header), block.rows.shape[1])
    raw = block.rows.view(wire)[name][:, 0]
    return _column(dict(layout.rows)[name], np.ascontiguousarray(raw))


def _columns(layout: Layout[Any], raw: Array, offsets: Array, real: type) -> Columns:
    columns = {'offset': offsets}
    for name, row in layout.rows:
        column = _column(row, np.ascontiguousarray(raw[name]))
        columns[name] = column.astype(real, copy=False) if column.dtype == np.float64 else column
    return columns


@lru_cache(maxsize=256)
def _wire_type(layout: Layout[Any], start: int = 0, size: int | None = None) -> np.dtype[Any]:
    """Return the type of a payload, which starts at a byte of elements of a size."""
    kinds: list[Any] = []
    offsets, offset = [], start
    for _, row in layout.rows:
        kind = np.dtype(f'V{row.code[:-1]}' if row.code.endswith('s')
                        else layout.byte_order + row.code)
        kinds.append(kind if row.count == 1 else (kind, (row.count,)))
        offsets.append(offset)
        offset += kind.itemsize * row.count + row.reserved
    return np.dtype({'names': [name for name, _ in layout.rows], 'formats': kinds,
                     'offsets': offsets, 'itemsize': size or start + layout.size})


def _column(row: Row, raw: Array) -> Array:
    """Decode the values of a field."""
    if row.scale is not None:
        values: Array = raw * row.scale
        return values + row.offset if row.offset else values
    if row.decode is None:
        return np.asarray(raw, raw.dtype.newbyteorder('='))
    if row.code.endswith('s'):
        values = np.empty(len(raw), object)
        values[:] = [row.decode(bytes(item)) for item in raw]
        return values
    if raw.dtype.itemsize <= _LOOKED_UP:
        return _table_of_values(row).decode(raw.astype(f'u{raw.dtype.itemsize}'))
    different, inverse = np.unique(raw, return_inverse=True)
    return _look_up(_decoded(row, different), inverse.reshape(raw.shape))


def _look_up(values: Array, indices: Array) -> Array:
    """Return values[indices]; elements as a whole are faster than rows of their parts."""
    if values.ndim == 1:
        return np.asarray(np.take(values, indices))
    rows = values.view(f'V{values.dtype.itemsize * values.shape[1]}')[:, 0]
    return np.take(rows, indices).view(values.dtype).reshape(-1, values.shape[1])


class _TableOfValues:
    """The values of a small field, by its bits as an unsigned number; each is decoded once."""

    def __init__(self, row: Row) -> None:
        self._row = row
        self._kind = np.dtype(row.code)
        sample = _decoded(row, np.zeros(1, self._kind))
        count = 256 ** self._kind.itemsize
        self._values = np.zeros((count, *sample.shape[1:]), sample.dtype)
        self._known = np.zeros(count, bool)

    def decode(self, bits: Array) -> Array:
        """Decode values, given by their bits."""
        known = np.take(self._known, bits)
        if not known.all():
            new = np.unique(bits[~known])
            self._values[new] = _decoded(self._row, new.view(self._kind))
            self._known[new] = True
        return _look_up(self._values, bits)


@lru_cache(maxsize=256)
def _table_of_values(row: Row) -> _TableOfValues:
    return _TableOfValues(row)


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
