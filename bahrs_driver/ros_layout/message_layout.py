# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The layout of a serialized ROS message, one row for each field of its values.

ROS serializes messages as CDR, the format of DDS: four bytes that name the encoding, then all
numbers in the order of the definition, each aligned to its own size, counted from the fifth byte.
A string is its size, including the zero byte at its end, as a uint32, and its bytes. So the only
thing that moves a field is the size of the strings before it. The strings of a topic hardly ever
change: one `struct` packs all of its messages, an Imu seven times faster than a message object is
made and serialized. Padding is zero.
"""

from collections.abc import Iterator
from enum import Enum
from functools import cached_property, lru_cache
import struct
from typing import Any, NamedTuple

from bahrs_driver.units import NS_PER_S

ENCAPSULATION = bytes((0, 1, 0, 0))     # CDR, little-endian
_SIZES = {'b': 1, 'B': 1, 'H': 2, 'i': 4, 'I': 4, 'd': 8}
_TYPES = {'b': 'int8', 'B': 'uint8', 'H': 'uint16', 'i': 'int32', 'I': 'uint32', 'd': 'double'}


class Kind(Enum):
    """How a value becomes fields."""

    NUMBER = 'one number'
    NUMBERS = 'a tuple of numbers'
    TIME = 'ns as sec and nanosec'
    TEXT = 'a string'


class Row(NamedTuple):
    """A field of the definition: its path, and the struct code of its numbers."""

    path: str
    kind: Kind
    code: str = ''
    members: tuple[str, ...] = ()       # names of the numbers of a nested message
    length: int = 1                     # of an array

    def fields(self) -> Iterator[tuple[str, str]]:
        """Yield path and type of each field, as in the definition."""
        number = _TYPES.get(self.code, '')
        if self.kind is Kind.TEXT:
            yield self.path, 'string'
        elif self.kind is Kind.TIME:
            yield f'{self.path}.sec', 'int32'
            yield f'{self.path}.nanosec', 'uint32'
        elif self.members:
            yield from ((f'{self.path}.{member}', number) for member in self.members)
        else:
            yield self.path, number if self.length == 1 else f'{number}[{self.length}]'


def number(path: str, code: str) -> Row:
    """Return the row of one number."""
    return Row(path, Kind.NUMBER, code)


def members(path: str, names: str) -> Row:
    """Return the row of a nested message of float64 with one-letter names, such as 'xyz'."""
    return Row(path, Kind.NUMBERS, 'd', tuple(names), len(names))


def array(path: str, length: int) -> Row:
    """Return the row of an array of float64."""
    return Row(path, Kind.NUMBERS, 'd', (), length)


def time(path: str) -> Row:
    """Return the row of a time in ns."""
    return Row(path, Kind.TIME)


def text(path: str) -> Row:
    """Return the row of a string."""
    return Row(path, Kind.TEXT)


HEADER = time('header.stamp'), text('header.frame_id')


class MessageLayout:
    """The layout of one message type; its rows are in the order of the values."""

    def __init__(self, name: str, *rows: Row) -> None:
        """Take the name of the type, such as sensor_msgs/msg/Imu, and its rows."""
        self.name = name
        self.rows = rows
        self._kinds = tuple(row.kind for row in rows)
        self._structs: dict[tuple[int, ...], struct.Struct] = {}

    @cached_property
    def fields(self) -> list[tuple[str, str]]:
        """Path and type of each field, in the order of the definition."""
        return [field for row in self.rows for field in row.fields()]

    def serialize(self, values: tuple[Any, ...]) -> bytes:
        """Return the serialized message; struct.error if a number does not fit its field."""
        arguments: list[Any] = [ENCAPSULATION]
        sizes: tuple[int, ...] = ()
        for kind, value in zip(self._kinds, values):
            if kind is Kind.NUMBERS:
                arguments += value
            elif kind is Kind.NUMBER:
                arguments.append(value)
            elif kind is Kind.TIME:
                arguments += divmod(value, NS_PER_S)
            else:
                data = _text_bytes(value)
                arguments += len(data), data
                sizes += (len(data),)
        packer = self._structs.get(sizes) or self._make_struct(sizes)
        return packer.pack(*arguments)

    def _make_struct(self, sizes: tuple[int, ...]) -> struct.Struct:
        """Return the struct of messages whose strings have these sizes."""
        texts = iter(sizes)
        codes, position = f'<{len(ENCAPSULATION)}s', 0
        for row in self.rows:
            for code, count in _codes(row, texts):
                size = _SIZES.get(code, 1)
                padding = -position % size
                codes += 'x' * padding + f'{count}{code}'
                position += padding + size * count
        return self._structs.setdefault(sizes, struct.Struct(codes))


def _codes(row: Row, texts: Iterator[int]) -> Iterator[tuple[str, int]]:
    """Yield struct code and count of the parts of a row."""
    if row.kind is Kind.TIME:
        yield from (('i', 1), ('I', 1))
    elif row.kind is Kind.TEXT:
        yield from (('I', 1), ('s', next(texts)))
    else:
        yield row.code, row.length


@lru_cache(maxsize=64)
def _text_bytes(value: str) -> bytes:
    return value.encode() + b'\0'
