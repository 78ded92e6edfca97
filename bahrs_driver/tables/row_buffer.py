# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Turn values, message by message, into blocks of columns.

Numbers go into arrays of machine numbers, never into lists of Python objects: a message costs
about as much time as its serialization. Most columns hardly ever change, such as those of a
covariance; one that is constant in a block has only one element in memory.
"""

from array import array
from collections.abc import Callable, Mapping
from functools import partial
import json
from typing import Any

from bahrs_driver.convert.outgoing import Values
from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.rows import Kind, Row
from bahrs_driver.tables.column import row_columns, TEXT, TIME
from bahrs_driver.units import NS_PER_S
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Block = Mapping[str, Array]         # by the names of columns

BLOCK_ROWS = 16_384         # 80 s at 200 Hz, in 5 MB
JSON_ROWS = 256             # of a table with sequences, in up to 2 MB
_JSON = Kind.DATA, Kind.RECORDS
_TEXTS = Kind.TEXT, *_JSON


class RowBuffer:
    """Collects the messages of one topic, whose values are of one class."""

    def __init__(self, kind: type) -> None:
        self._rows = LAYOUTS[kind].rows
        self._limit = JSON_ROWS if any(row.kind in _JSON for row in self._rows) else BLOCK_ROWS
        self._begin()

    @property
    def is_full(self) -> bool:
        """Whether the block has its full size, and take() should be called."""
        return self.count >= self._limit

    def append(self, time_ns: int, values: Values) -> None:
        """Append a message; OverflowError if a number does not fit its field."""
        self.count += 1
        self._add_time(time_ns)
        for add, value in zip(self._adders, values):
            add(value)

    def take(self) -> Block:
        """Return the columns of the messages since the last call."""
        columns: dict[str, Array] = {TIME: np.frombuffer(self._times, 'q')}
        for row, buffer in zip(self._rows, self._buffers):
            columns.update(zip((column.name for column in row_columns(row)),
                               map(compact, _arrays(row, buffer))))
        self._begin()
        return columns

    def _begin(self) -> None:
        self.count = 0
        self._times = array('q')
        self._add_time = self._times.append
        self._buffers: list[Any] = [_buffer(row) for row in self._rows]
        self._adders = list(map(_adder, self._rows, self._buffers))


def is_constant(column: Array) -> bool:
    """Return whether a column has only one element in memory."""
    return len(column) == 1 or column.strides == (0,)


def compact(column: Array) -> Array:
    """Return the column, with one element in memory if all rows are equal; it has rows."""
    # Compared as bits, because NaN does not equal itself, and -0.0 equals 0.0.
    bits = column if column.dtype == TEXT else column.view(f'u{column.itemsize}')
    return repeated(column, len(column)) if (bits == bits[0]).all() else column


def repeated(column: Array, count: int) -> Array:
    """Return a column with the first element of another one in each row."""
    return np.broadcast_to(column[:1].copy(), count)


def _buffer(row: Row) -> Any:
    if row.kind in _TEXTS:
        return []
    return array('q' if row.kind is Kind.TIME else row.code)


def _adder(row: Row, buffer: Any) -> Callable[[Any], None]:
    """Return the function that appends a value of a row to its buffer."""
    if row.kind is Kind.NUMBERS:
        return buffer.extend        # type: ignore[no-any-return]
    if row.kind in _JSON:
        return partial(_append_json, buffer, row)
    return buffer.append            # type: ignore[no-any-return]


def _append_json(buffer: list[str], row: Row, value: Any) -> None:
    buffer.append(json.dumps(_plain(row, value)))


def _plain(row: Row, value: Any) -> Any:
    """Return a value as JSON values."""
    if row.kind is Kind.RECORDS:
        return [{inner.path: _plain(inner, item) for inner, item in zip(row.rows, record)}
                for record in value]
    if row.kind is Kind.DATA:
        return list(value)
    return value[0] if row.code == 'c' else value


def _arrays(row: Row, buffer: Any) -> list[Array]:
    """Return the columns of a row."""
    if row.kind in _TEXTS:
        return [np.array(buffer, TEXT)]
    numbers = np.frombuffer(buffer, buffer.typecode)
    if row.kind is Kind.TIME:
        seconds, nanoseconds = np.divmod(numbers, NS_PER_S)
        return [seconds.astype('i'), nanoseconds.astype('I')]
    return list(np.ascontiguousarray(numbers.reshape(-1, row.length).T))
