# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a table as a Parquet file, a block of rows at a time."""

from pathlib import Path
from typing import Any

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import guard, guard_new
from bahrs_driver.ros_layout.layouts import type_name
from bahrs_driver.tables.column import Column, table_columns, TEXT
from bahrs_driver.tables.row_buffer import Array, Block, is_constant
import numpy as np

FRAME = 'header.frame_id'


class ParquetSink:
    """
    A file with a row group for each block. Methods raise WriteError.

    Metadata of the schema: message_type, and frame_id if messages have one. Metadata of a column:
    unit, if it has one.
    """

    def __init__(self, path: Path, kind: type) -> None:
        """Create the file for a class of values."""
        self._arrow, self._parquet = _pyarrow()
        self._path = path
        self._kind = kind
        self._columns = table_columns(kind)
        with guard_new(path):
            self._file = path.open('xb')
        self._writer: Any = None

    def write(self, block: Block) -> None:
        """Append a row group."""
        with guard(self._path):
            if self._writer is None:
                self._begin(str(block[FRAME][0]) if FRAME in block else '')
            self._writer.write_table(self._arrow.Table.from_arrays(
                [self._array(block[column.name], column) for column in self._columns],
                schema=self._writer.schema))

    def close(self) -> None:
        """Complete the file; a table without rows has its schema only."""
        with guard(self._path), self._file:
            if self._writer is None:
                self._begin('')
            self._writer.close()

    def _begin(self, frame_id: str) -> None:
        metadata = {'message_type': type_name(self._kind)}
        if frame_id:
            metadata['frame_id'] = frame_id
        self._writer = self._parquet.ParquetWriter(
            self._file, self._arrow.schema(map(self._field, self._columns), metadata),
            compression='zstd',
            # Measured numbers hardly repeat.
            use_dictionary=[column.name for column in self._columns if column.dtype == TEXT])

    def _field(self, column: Column) -> Any:
        metadata = {'unit': column.unit} if column.unit else None
        return self._arrow.field(column.name, self._type(column), False, metadata)

    def _type(self, column: Column) -> Any:
        return self._arrow.string() if column.dtype == TEXT \
            else self._arrow.from_numpy_dtype(np.dtype(column.dtype))

    def _array(self, values: Array, column: Column) -> Any:
        if is_constant(values):
            return self._arrow.repeat(
                self._arrow.scalar(values[:1].tolist()[0], self._type(column)), len(values))
        return self._arrow.array(values, self._type(column))


def _pyarrow() -> tuple[Any, Any]:
    """Import what writes Parquet files; WriteError if it is not installed."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise WriteError('cannot write Parquet files: the Python package pyarrow is not '
                         'installed: pip install pyarrow') from error
    return pyarrow, parquet
