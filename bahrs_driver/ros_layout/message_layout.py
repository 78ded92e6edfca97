# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The layout of a serialized ROS message without sequences, one row for each field of its values.

ROS serializes messages as CDR, the format of DDS: four bytes that name the encoding, then all
numbers in the order of the definition, each aligned to its own size, counted from the fifth byte.
A string is its size, including the zero byte at its end, as a uint32, and its bytes. So the only
thing that moves a field is the size of the strings before it. The strings of a topic hardly ever
change: one `struct` packs all of its messages, an Imu seven times faster than a message object is
made and serialized. Padding is zero.
"""

from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from itertools import chain, groupby
import struct
from typing import Any

from bahrs_driver.ros_layout.rows import Kind, Row, SIZES
from bahrs_driver.units import NS_PER_S

_NUMBERS, _NUMBER, _TEXT = Kind.NUMBERS, Kind.NUMBER, Kind.TEXT
_joined = chain.from_iterable
ENCAPSULATION = bytes((0, 1, 0, 0))     # CDR, little-endian


class MessageLayout:
    """The layout of one message type; its rows are in the order of the values."""

    def __init__(self, name: str, *rows: Row) -> None:
        """Take the name of the type, such as sensor_msgs/msg/Imu, and its rows."""
        self.name = name
        self.rows = rows
        self._parts = parts_of(rows)
        self._packers: dict[tuple[int, ...], Callable[..., bytes]] = {}

    @cached_property
    def fields(self) -> list[tuple[str, str]]:
        """Path and type of each field, in the order of the definition."""
        return [field for row in self.rows for field in row.fields()]

    def serialize(self, values: tuple[Any, ...]) -> bytes:
        """Return the serialized message; struct.error if a number does not fit its field."""
        arguments: list[Any] = [ENCAPSULATION]
        sizes: tuple[int, ...] = ()
        for kind, part in self._parts:
            if kind is _NUMBERS:
                arguments += _joined(values[part])
            elif kind is _NUMBER:
                arguments += values[part]
            elif kind is _TEXT:
                for value in values[part]:
                    data = text_bytes(value)
                    arguments += len(data), data
                    sizes += (len(data),)
            else:
                for value in values[part]:
                    arguments += divmod(value, NS_PER_S)
        return self.packer(sizes)(*arguments)

    def packer(self, sizes: tuple[int, ...]) -> Callable[..., bytes]:
        """Return the function that packs messages whose strings have these sizes."""
        return self._packers.get(sizes) or self._make_packer(sizes)

    def _make_packer(self, sizes: tuple[int, ...]) -> Callable[..., bytes]:
        texts = iter(sizes)
        codes, position = f'<{len(ENCAPSULATION)}s', 0
        for row in self.rows:
            for code, count in _codes(row, texts):
                size = SIZES.get(code, 1)
                padding = -position % size
                codes += 'x' * padding + f'{count}{code}'
                position += padding + size * count
        return self._packers.setdefault(sizes, struct.Struct(codes).pack)


def parts_of(rows: tuple[Row, ...]) -> list[tuple[Kind, slice]]:
    """Return the rows of one kind that follow each other, as parts of the values."""
    parts, end = [], 0
    for kind, group in groupby(row.kind for row in rows):
        begin, end = end, end + len(list(group))
        parts.append((kind, slice(begin, end)))
    return parts


def _codes(row: Row, texts: Iterator[int]) -> Iterator[tuple[str, int]]:
    """Yield struct code and count of the parts of a row."""
    if row.kind is Kind.TIME:
        yield from (('i', 1), ('I', 1))
    elif row.kind is Kind.TEXT:
        yield from (('I', 1), ('s', next(texts)))
    else:
        yield row.code, row.length


@lru_cache(maxsize=64)
def text_bytes(value: str) -> bytes:
    """Return the bytes of a string, which end in a zero."""
    return value.encode() + b'\0'
