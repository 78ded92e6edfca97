# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The wire layout of messages: one row for each field, for decoding and encoding.

A message is a frozen dataclass with slots, whose fields are declared with `wire(row)`. A row has
the struct code of its field and the conversion between the raw number and the SI value. A Layout
compiles the rows of one message for one protocol version. Decoding and encoding use the same rows,
so that they cannot disagree.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, fields, replace
from itertools import islice
import struct
from typing import Any, Generic, TypeVar

from bahrs_driver.protocol.integrity import two_bit_fields, valid_bits
from bahrs_driver.protocol.message_decoder import message_decoder
from bahrs_driver.protocol.message_encoder import message_encoder
from bahrs_driver.protocol.row import Row

Vector = tuple[float, float, float]
Message = TypeVar('Message')
_MISFITS = struct.error, TypeError, ValueError, OverflowError       # of values and fields


def integer(code: str, unit: str = '') -> Row:
    """Return the row of an integer without a scale."""
    return Row(code, unit=unit)


def scaled(code: str, scale: float, unit: str, offset: float = 0.0) -> Row:
    """Return the row of a quantity: value = scale * raw + offset."""
    return Row(code, unit=unit, scale=scale, offset=offset)


def deviation(code: str, scale: float, unit: str) -> Row:
    """Return the row of a standard deviation, for which the raw value 0 means invalid (None)."""

    def decode(raw: int) -> float | None:
        return raw * scale if raw else None

    def encode(value: float | None) -> int:
        if value is None:
            return 0
        return round(value / scale) or int(value > 0)

    return Row(code, unit=unit, decode=decode, encode=encode)


def vector(code: str, scale: float, unit: str) -> Row:
    """Return the row of three scaled components, x first."""
    return Row(code, 3, unit, scale)


def integers(code: str, count: int) -> Row:
    """Return the row of several integers without a scale."""
    return Row(code, count)


def real(code: str, unit: str = '') -> Row:
    """Return the row of a floating-point number without a scale."""
    return Row(code, unit=unit)


def reals(code: str, count: int, unit: str = '') -> Row:
    """Return the row of several floating-point numbers without a scale."""
    return Row(code, count, unit)


def text(size: int) -> Row:
    """Return the row of a Latin-1 string, padded with zero bytes to its size."""

    def decode(raw: bytes) -> str:
        return raw.rstrip(b'\0').decode('latin-1')

    def encode(value: str) -> bytes:
        data = value.encode('latin-1')
        if len(data) > size:
            raise ValueError(f'{value!r} is longer than {size} bytes')
        return data

    return Row(f'{size}s', decode=decode, encode=encode)


def block(size: int) -> Row:
    """Return the row of `size` unchanged bytes."""

    def encode(value: bytes) -> bytes:
        if len(value) != size:
            raise ValueError(f'{len(value)} bytes given, {size} needed')
        return value

    return Row(f'{size}s', decode=bytes, encode=encode)


def flag(raised: int) -> Row:
    """Return the row of a byte that is true for one value, 0 or 1, and false for any other."""
    return Row('B', decode=lambda raw: raw == raised,
               encode=lambda value: raised if value else 1 - raised)


def before_reserved(size: int, row: Row) -> Row:
    """Return the row with `size` reserved bytes after it."""
    return replace(row, reserved=size)


def integrity_fields(code: str, count: int) -> Row:
    """Return the row of a health word with two bits per signal."""
    decode, encode = two_bit_fields(count)
    return Row(code, decode=decode, encode=encode)


def valid_flags(code: str, count: int) -> Row:
    """Return the row of a health byte with one valid bit per signal."""
    decode, encode = valid_bits(count)
    return Row(code, decode=decode, encode=encode)


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
        self.rows: Sequence[tuple[str, Row]] = [        # names and rows of the fields, in order
            (item.name, (replace or {}).get(item.name) or _row_for(item.metadata['rows'], version))
            for item in fields(message)]  # type: ignore[arg-type]
        self._struct = _packer(self.rows, byte_order)
        self.size = self._struct.size
        # A function of bytes and of the start of the payload (0), which takes any content.
        self.decode: Callable[..., Message] = message_decoder(message, self.rows, self._struct)
        self._encode = message_encoder(self.rows, self._struct)

    def raw(self, payload: bytes, start: int = 0) -> dict[str, Any]:
        """Return the raw numbers on the wire by field name."""
        numbers = iter(self._struct.unpack_from(payload, start))
        return {name: next(numbers) if row.count == 1 else tuple(islice(numbers, row.count))
                for name, row in self.rows}

    def encode(self, message: Message) -> bytes:
        """Encode a message; raise ValueError if a value does not fit its field."""
        try:
            return self._encode(message)
        except _MISFITS:
            for name, row in self.rows:
                self._check(name, row, message)
            raise

    def _check(self, name: str, row: Row, message: Message) -> None:
        """Raise ValueError if the value of a field does not fit."""
        rows = [(name, row)]
        try:
            message_encoder(rows, _packer(rows, self.byte_order))(message)
        except _MISFITS as error:
            value, unit = getattr(message, name), row.unit and ' ' + row.unit
            raise ValueError(f'{name}: {value}{unit} does not fit its field ({error})') from error


def _packer(rows: Sequence[tuple[str, Row]], byte_order: str) -> struct.Struct:
    return struct.Struct(byte_order + ''.join(row.wire_code for _, row in rows))


def _row_for(rows: Mapping[int, Row], version: int) -> Row:
    return rows[max(first for first in rows if first <= version)]
