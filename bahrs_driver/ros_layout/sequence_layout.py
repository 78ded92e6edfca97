# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The layout of a serialized ROS message with sequences.

A sequence is the number of its elements as a uint32, and the elements. It moves all fields behind
it, so each field is packed alone. That is slower, but such messages are rare, or consist of one
large block of bytes.
"""

from collections.abc import Callable, Iterable, Mapping
import struct
from typing import Any

from bahrs_driver.ros_layout.message_layout import ENCAPSULATION, MessageLayout
from bahrs_driver.ros_layout.rows import Kind, Row, SIZES
from bahrs_driver.units import NS_PER_S

# Appends a value to a message.
_Appender = Callable[[bytearray, Any], None]


class SequenceLayout(MessageLayout):
    """The layout of one message type, some of whose rows are sequences."""

    def __init__(self, name: str, *rows: Row) -> None:
        """Take the name of the type, and its rows."""
        super().__init__(name, *rows)
        self._append = _fields(rows)

    def serialize(self, values: tuple[Any, ...]) -> bytes:
        """Return the serialized message; struct.error if a number does not fit its field."""
        message = bytearray(ENCAPSULATION)
        self._append(message, values)
        return bytes(message)


def _fields(rows: Iterable[Row]) -> _Appender:
    appenders = list(map(_appender, rows))

    def append(message: bytearray, values: Any) -> None:
        for append_field, value in zip(appenders, values):
            append_field(message, value)
    return append


def _appender(row: Row) -> _Appender:
    if row.kind is Kind.RECORDS:
        return _records(row.rows)
    if row.kind is Kind.NUMBERS:
        return _numbers(row.code, row.length)
    if row.kind is Kind.NUMBER:
        return _number(row.code)
    return _APPENDERS[row.kind]


def _number(code: str) -> _Appender:
    pack, size = struct.Struct(f'<{code}').pack, SIZES[code]

    def append(message: bytearray, value: Any) -> None:
        message += bytes((len(ENCAPSULATION) - len(message)) % size) + pack(value)
    return append


def _numbers(code: str, length: int) -> _Appender:
    pack, size = struct.Struct(f'<{length}{code}').pack, SIZES[code]

    def append(message: bytearray, value: Any) -> None:
        message += bytes((len(ENCAPSULATION) - len(message)) % size) + pack(*value)
    return append


def _records(rows: Iterable[Row]) -> _Appender:
    append_record = _fields(rows)

    def append(message: bytearray, value: Any) -> None:
        _append_uint32(message, len(value))
        for record in value:
            append_record(message, record)
    return append


_append_int32, _append_uint32 = _number('i'), _number('I')


def _append_data(message: bytearray, value: bytes) -> None:
    _append_uint32(message, len(value))
    message += value


def _append_text(message: bytearray, value: str) -> None:
    _append_data(message, value.encode() + b'\0')


def _append_time(message: bytearray, value: int) -> None:
    seconds, nanoseconds = divmod(value, NS_PER_S)
    _append_int32(message, seconds)
    _append_uint32(message, nanoseconds)


_APPENDERS: Mapping[Kind, _Appender] = {
    Kind.TEXT: _append_text, Kind.DATA: _append_data, Kind.TIME: _append_time}
