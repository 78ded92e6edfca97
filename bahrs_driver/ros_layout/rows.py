# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The rows of a layout: each describes one value, and the fields of a ROS message it becomes."""

from collections.abc import Iterator
from enum import Enum
from typing import NamedTuple

# Of the struct codes of numbers: bytes of each, and its type in a definition.
SIZES = {'b': 1, 'B': 1, 'c': 1, 'H': 2, 'i': 4, 'I': 4, 'd': 8}
_TYPES = {'b': 'int8', 'B': 'uint8', 'c': 'octet', 'H': 'uint16', 'i': 'int32', 'I': 'uint32',
          'd': 'double'}


class Kind(Enum):
    """How a value becomes fields."""

    NUMBER = 'one number'
    NUMBERS = 'a tuple of numbers'
    TIME = 'ns as sec and nanosec'
    TEXT = 'a string'
    DATA = 'bytes as a sequence of uint8'
    RECORDS = 'a tuple of tuples as a sequence of messages'


class Row(NamedTuple):
    """A field of the definition: its path, and the struct code of its numbers."""

    path: str
    kind: Kind
    code: str = ''
    members: tuple[str, ...] = ()       # names of the numbers of a nested message
    length: int = 1                     # of an array
    unit: str = ''                      # of the numbers
    type_name: str = ''                 # of the messages of a sequence
    rows: 'tuple[Row, ...]' = ()        # of the messages of a sequence

    def fields(self) -> Iterator[tuple[str, str]]:
        """Yield path and type of each field, as in the definition."""
        number = _TYPES.get(self.code, '')
        if self.kind is Kind.TEXT:
            yield self.path, 'string'
        elif self.kind is Kind.TIME:
            yield f'{self.path}.sec', 'int32'
            yield f'{self.path}.nanosec', 'uint32'
        elif self.kind is Kind.DATA:
            yield self.path, 'sequence<uint8>'
        elif self.kind is Kind.RECORDS:
            yield self.path, f"sequence<{self.type_name.replace('/msg/', '/')}>"
            for row in self.rows:
                yield from ((f'{self.path}[].{path}', kind) for path, kind in row.fields())
        elif self.members:
            yield from ((f'{self.path}.{member}', number) for member in self.members)
        else:
            yield self.path, number if self.length == 1 else f'{number}[{self.length}]'


def number(path: str, code: str, unit: str = '') -> Row:
    """Return the row of one number; 'c' is a ROS byte, in Python a bytes object of length 1."""
    return Row(path, Kind.NUMBER, code, unit=unit)


def members(path: str, names: str, unit: str = '') -> Row:
    """Return the row of a nested message of float64 with one-letter names, such as 'xyz'."""
    return Row(path, Kind.NUMBERS, 'd', tuple(names), len(names), unit)


def array(path: str, length: int, unit: str = '') -> Row:
    """Return the row of an array of float64."""
    return Row(path, Kind.NUMBERS, 'd', (), length, unit)


def time(path: str) -> Row:
    """Return the row of a time in ns."""
    return Row(path, Kind.TIME)


def text(path: str) -> Row:
    """Return the row of a string."""
    return Row(path, Kind.TEXT)


def data(path: str) -> Row:
    """Return the row of a sequence of bytes."""
    return Row(path, Kind.DATA)


def records(path: str, type_name: str, *rows: Row) -> Row:
    """Return the row of a sequence of messages of a type, such as diagnostic_msgs/msg/KeyValue."""
    return Row(path, Kind.RECORDS, type_name=type_name, rows=rows)


HEADER = time('header.stamp'), text('header.frame_id')
