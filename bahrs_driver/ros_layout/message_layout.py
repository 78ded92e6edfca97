# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The layout of a serialized ROS message without sequences, one row for each field of its values.

ROS serializes messages as CDR, the format of DDS: four bytes that name the encoding, then all
numbers in the order of the definition, each aligned to its own size, counted from the fifth byte.
A string is its size, including the zero byte at its end, as a uint32, and its bytes. So the only
thing that moves a field is the size of the strings before it. The strings of a topic hardly ever
change: one `struct` packs all of its messages. Padding is zero.

A loop over the rows would take longer than the `struct`. So each layout is compiled into a
function. For a FluidPressure:

    def serialize(values):
        value0, value1, value2, value3, = values
        value1 = encode(value1)
        sizes = (len(value1), )
        pack = packers.get(sizes) or make_packer(sizes)
        return pack(start, *divmod(value0, 1000000000), len(value1), value1, value2, value3)
"""

from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
import struct
from typing import Any

from bahrs_driver.ros_layout.rows import Kind, Row, SIZES
from bahrs_driver.units import NS_PER_S

ENCAPSULATION = bytes((0, 1, 0, 0))     # CDR, little-endian


class MessageLayout:
    """The layout of one message type; its rows are in the order of the values."""

    def __init__(self, name: str, *rows: Row) -> None:
        """Take the name of the type, such as sensor_msgs/msg/Imu, and its rows."""
        self.name = name
        self.rows = rows

    @cached_property
    def fields(self) -> list[tuple[str, str]]:
        """Path and type of each field, in the order of the definition."""
        return [field for row in self.rows for field in row.fields()]

    @cached_property
    def serialize(self) -> Callable[[tuple[Any, ...]], bytes]:
        """Function from values to a message; struct.error if a number does not fit its field."""
        packers: dict[tuple[int, ...], Callable[..., bytes]] = {}

        def make_packer(sizes: tuple[int, ...]) -> Callable[..., bytes]:
            return packers.setdefault(sizes, self._make_struct(sizes).pack)

        scope: dict[str, Any] = {'encode': _encode, 'packers': packers, 'start': ENCAPSULATION,
                                 'make_packer': make_packer}
        exec(_source(self.rows), scope)
        function: Callable[[tuple[Any, ...]], bytes] = scope['serialize']
        return function

    def _make_struct(self, sizes: tuple[int, ...]) -> struct.Struct:
        """Return the struct of messages whose strings have these sizes."""
        texts = iter(sizes)
        codes, position = f'<{len(ENCAPSULATION)}s', 0
        for row in self.rows:
            for code, count in _codes(row, texts):
                size = SIZES.get(code, 1)
                padding = -position % size
                codes += 'x' * padding + f'{count}{code}'
                position += padding + size * count
        return struct.Struct(codes)


def _source(rows: tuple[Row, ...]) -> str:
    """Return the source code of the function that serializes."""
    names = [f'value{index}' for index in range(len(rows))]
    texts = [name for name, row in zip(names, rows) if row.kind is Kind.TEXT]
    lines = [
        'def serialize(values):',
        ''.join(f'{name}, ' for name in names) + '= values',
        *(f'{name} = encode({name})' for name in texts),
        f"sizes = ({''.join(f'len({name}), ' for name in texts)})",
        'pack = packers.get(sizes) or make_packer(sizes)',
        f"return pack({', '.join(['start', *map(_arguments, names, rows)])})"]
    return '\n    '.join(lines)


def _arguments(name: str, row: Row) -> str:
    """Return the source code of what is packed for a value."""
    if row.kind is Kind.TIME:
        return f'*divmod({name}, {NS_PER_S})'
    if row.kind is Kind.TEXT:
        return f'len({name}), {name}'
    return f'*{name}' if row.kind is Kind.NUMBERS else name


def _codes(row: Row, texts: Iterator[int]) -> Iterator[tuple[str, int]]:
    """Yield struct code and count of the parts of a row."""
    if row.kind is Kind.TIME:
        yield from (('i', 1), ('I', 1))
    elif row.kind is Kind.TEXT:
        yield from (('I', 1), ('s', next(texts)))
    else:
        yield row.code, row.length


@lru_cache(maxsize=64)
def _encode(value: str) -> bytes:
    return value.encode() + b'\0'
