# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Turn the values of messages into blocks of columns.

Numbers go into arrays of machine numbers, many messages at a time. Most columns hardly ever
change, such as those of a covariance, for which converters return the same tuple again and again;
a column that is constant in a block has only one element in memory.
"""

from array import array
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
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
        return len(self._times) >= self._limit

    @property
    def is_empty(self) -> bool:
        """Whether the block has no message."""
        return not self._times

    def extend(self, messages: Iterable[tuple[int, Values]]) -> None:
        """Append messages with their log times; OverflowError if a number does not fit."""
        times, values = zip(*messages)
        self._times.extend(times)
        for row, buffer, column in zip(self._rows, self._buffers, zip(*values)):
            _extend(buffer, row, column)

    def take(self) -> Block:
        """Return the columns of the messages since the last call."""
        columns: dict[str, Array] = {TIME: np.frombuffer(self._times, 'q')}
        for row, buffer in zip(self._rows, self._buffers):
            columns.update(zip((column.name for column in row_columns(row)),
                               map(compact, _arrays(row, buffer))))
        self._begin()
        return columns

    def _begin(self) -> None:
        self._times = array('q')
        self._buffers: list[Any] = [_buffer(row) for row in self._rows]


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


def _extend(buffer: Any, row: Row, values: Sequence[Any]) -> None:
    if row.kind is Kind.NUMBERS:
        buffer.frombytes(_numbers(row, values))
    elif row.kind in _JSON:
        buffer.extend(json.dumps(_plain(row, value)) for value in values)
    else:
        buffer.extend(values)


def _numbers(row: Row, tuples: Sequence[tuple[Any, ...]]) -> bytes:
    """Return the numbers of tuples, one after another."""
    if len(set(map(id, tuples))) == 1:      # the same object in each message
        return array(row.code, tuples[0]).tobytes() * len(tuples)
    return np.fromiter(chain.from_iterable(tuples), row.code).tobytes()


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
