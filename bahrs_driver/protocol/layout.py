# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The wire layout of messages: one row for each field, for decoding and encoding.

A message is a frozen dataclass whose fields are declared with `wire(row)`. A row has the struct
code of its field and the two functions between the raw number and the SI value. A Layout compiles
the rows of one message for one protocol version. Decoding and encoding use the same rows, so that
they cannot disagree.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from operator import index
import struct
from typing import Any, Generic, TypeVar

from bahrs_driver.protocol.integrity import two_bit_fields, valid_bits

Vector = tuple[float, float, float]
Message = TypeVar('Message')


@dataclass(frozen=True)
class Row:
    """
    One field on the wire: its struct code, its count of repetitions, and both conversions.

    `reserved` bytes follow it. They are ignored, and written as zeros.
    """

    code: str
    decode: Callable[[Any], Any]
    encode: Callable[[Any], Any]
    count: int = 1
    unit: str = ''
    reserved: int = 0

    @property
    def plain(self) -> bool:
        """Whether the raw number is the value."""
        return self.decode in (_same, tuple)


def _same(value: Any) -> Any:
    return value


def integer(code: str, unit: str = '') -> Row:
    """Return the row of an integer without a scale."""
    return Row(code, _same, index, unit=unit)


def scaled(code: str, scale: float, unit: str, offset: float = 0.0) -> Row:
    """Return the row of a quantity: value = scale * raw + offset."""

    def decode(raw: int) -> float:
        return raw * scale + offset

    def encode(value: float) -> int:
        return round((value - offset) / scale)

    return Row(code, decode, encode, unit=unit)


def deviation(code: str, scale: float, unit: str) -> Row:
    """Return the row of a standard deviation, for which the raw value 0 means invalid (None)."""

    def decode(raw: int) -> float | None:
        return raw * scale if raw else None

    def encode(value: float | None) -> int:
        if value is None:
            return 0
        return round(value / scale) or int(value > 0)

    return Row(code, decode, encode, unit=unit)


def vector(code: str, scale: float, unit: str) -> Row:
    """Return the row of three scaled components, x first."""

    def decode(raw: tuple[int, int, int]) -> Vector:
        x, y, z = raw
        return x * scale, y * scale, z * scale

    def encode(value: Vector) -> tuple[int, ...]:
        return tuple(round(component / scale) for component in value)

    return Row(code, decode, encode, count=3, unit=unit)


def integers(code: str, count: int) -> Row:
    """Return the row of several integers without a scale."""
    return Row(code, tuple, tuple, count=count)


def real(code: str, unit: str = '') -> Row:
    """Return the row of a floating-point number without a scale."""
    return Row(code, _same, float, unit=unit)


def reals(code: str, count: int, unit: str = '') -> Row:
    """Return the row of several floating-point numbers without a scale."""
    return Row(code, tuple, tuple, count=count, unit=unit)


def text(size: int) -> Row:
    """Return the row of a Latin-1 string, padded with zero bytes to its size."""

    def decode(raw: bytes) -> str:
        return raw.rstrip(b'\0').decode('latin-1')

    def encode(value: str) -> bytes:
        data = value.encode('latin-1')
        if len(data) > size:
            raise ValueError(f'{value!r} is longer than {size} bytes')
        return data

    return Row(f'{size}s', decode, encode)


def block(size: int) -> Row:
    """Return the row of `size` unchanged bytes."""

    def encode(value: bytes) -> bytes:
        if len(value) != size:
            raise ValueError(f'{len(value)} bytes given, {size} needed')
        return value

    return Row(f'{size}s', bytes, encode)


def flag(raised: int) -> Row:
    """Return the row of a byte that is true for one value, 0 or 1, and false for any other."""
    return Row('B', lambda raw: raw == raised, lambda value: raised if value else 1 - raised)


def before_reserved(size: int, row: Row) -> Row:
    """Return the row with `size` reserved bytes after it."""
    return Row(row.code, row.decode, row.encode, row.count, row.unit, size)


def integrity_fields(code: str, count: int) -> Row:
    """Return the row of a health word with two bits per signal."""
    return Row(code, *two_bit_fields(count))


def valid_flags(code: str, count: int) -> Row:
    """Return the row of a health byte with one valid bit per signal."""
    return Row(code, *valid_bits(count))


def wire(row: Row | Mapping[int, Row]) -> Any:
    """
    Declare a dataclass field with its row.

    If the row differs between protocol versions, a mapping has the first version of each row.
    """
    return field(metadata={'rows': {1: row} if isinstance(row, Row) else dict(row)})


class Layout(Generic[Message]):
    """The wire layout of one message in one protocol version."""

    def __init__(self, message: type[Message], version: int = 1, byte_order: str = '<',
                 replace: Mapping[str, Row] | None = None) -> None:
        self.message = message
        self.byte_order = byte_order
        self._rows: list[tuple[str, Row, struct.Struct]] = []
        # How to decode each field, None if the number is the value, and which numbers it has.
        self._steps: list[tuple[Callable[[Any], Any] | None, int | slice]] = []
        codes, position = '', 0
        for item in fields(message):  # type: ignore[arg-type]
            row = (replace or {}).get(item.name) or _row_for(item.metadata['rows'], version)
            code = row.code if row.count == 1 else f'{row.count}{row.code}'
            code += 'x' * row.reserved
            self._rows.append((item.name, row, struct.Struct(byte_order + code)))
            part: int | slice = position if row.count == 1 else slice(
                position, position + row.count)
            self._steps.append((None if row.plain else row.decode, part))
            codes += code
            position += row.count
        self._struct = struct.Struct(byte_order + codes)
        self.size = self._struct.size

    @property
    def rows(self) -> list[tuple[str, Row]]:
        """Names and rows of the fields, in order."""
        return [(name, row) for name, row, _ in self._rows]

    def raw(self, payload: bytes, start: int = 0) -> dict[str, Any]:
        """Return the raw numbers on the wire by field name."""
        values = self._struct.unpack_from(payload, start)
        return {name: values[part] for (name, _, _), (_, part) in zip(self._rows, self._steps)}

    def decode(self, payload: bytes, start: int = 0) -> Message:
        """Decode the payload that begins at start. Any content is valid."""
        values = self._struct.unpack_from(payload, start)
        return self.message(*[decode(values[part]) if decode else values[part]
                              for decode, part in self._steps])

    def encode(self, message: Message) -> bytes:
        """Encode a message; raise ValueError if a value does not fit its field."""
        return b''.join(_pack(name, row, packer, getattr(message, name))
                        for name, row, packer in self._rows)


def _pack(name: str, row: Row, packer: struct.Struct, value: Any) -> bytes:
    try:
        raw = row.encode(value)
        return packer.pack(raw) if row.count == 1 else packer.pack(*raw)
    except (struct.error, TypeError, ValueError, OverflowError) as error:
        unit = row.unit and ' ' + row.unit
        raise ValueError(f'{name}: {value}{unit} does not fit its field ({error})') from error


def _row_for(rows: Mapping[int, Row], version: int) -> Row:
    return rows[max(first for first in rows if first <= version)]
