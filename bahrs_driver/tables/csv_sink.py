# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a table as a file of comma-separated values."""

from collections.abc import Iterable
from pathlib import Path

from bahrs_driver.files.live_file import LiveFile
from bahrs_driver.tables.column import table_columns, TEXT
from bahrs_driver.tables.row_buffer import Array, Block, is_constant

_SPECIAL = frozenset(',"\r\n')      # characters of a text that needs quotes


class CsvSink:
    """A file with the names of the columns, and a line for each row. Methods raise WriteError."""

    def __init__(self, path: Path, kind: type) -> None:
        """Create the file for a class of values."""
        self._columns = table_columns(kind)
        self._file = LiveFile(path)
        self._file.write(_lines([[column.name] for column in self._columns]))

    def write(self, block: Block) -> None:
        """Append a line for each row; floats are the shortest text that gives the same number."""
        self._file.write(_lines([_texts(block[column.name]) for column in self._columns]))

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _lines(columns: Iterable[list[str]]) -> str:
    return '\n'.join(map(','.join, zip(*columns))) + '\n'


def _texts(column: Array) -> list[str]:
    as_text = _quoted if column.dtype == TEXT else repr
    if is_constant(column):
        return [as_text(column[:1].tolist()[0])] * len(column)
    return list(map(as_text, column.tolist()))


def _quoted(text: str) -> str:
    if _SPECIAL.isdisjoint(text):
        return text
    return '"' + text.replace('"', '""') + '"'
