# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The layout of a serialized ROS message with sequences.

A sequence is the number of its elements as a uint32, and the elements. As they move all fields
behind them, each field is packed by itself: these messages are rare, or nearly all of them is one
block of bytes.
"""

from collections.abc import Iterable
import struct
from typing import Any

from bahrs_driver.ros_layout.message_layout import ENCAPSULATION, MessageLayout
from bahrs_driver.ros_layout.rows import Kind, Row, SIZES
from bahrs_driver.units import NS_PER_S


class SequenceLayout(MessageLayout):
    """The layout of one message type, some of whose rows are sequences."""

    def serialize(self, values: tuple[Any, ...]) -> bytes:
        """Return the serialized message; struct.error if a number does not fit its field."""
        message = bytearray(ENCAPSULATION)
        _append(message, self.rows, values)
        return bytes(message)


def _append(message: bytearray, rows: Iterable[Row], values: tuple[Any, ...]) -> None:
    for row, value in zip(rows, values):
        if row.kind is Kind.RECORDS:
            _append_numbers(message, 'I', len(value))
            for record in value:
                _append(message, row.rows, record)
        elif row.kind is Kind.TEXT:
            _append_bytes(message, value.encode() + b'\0')
        elif row.kind is Kind.DATA:
            _append_bytes(message, value)
        elif row.kind is Kind.TIME:
            seconds, nanoseconds = divmod(value, NS_PER_S)
            _append_numbers(message, 'i', seconds)
            _append_numbers(message, 'I', nanoseconds)
        else:
            _append_numbers(message, row.code, *(value if row.kind is Kind.NUMBERS else (value,)))


def _append_bytes(message: bytearray, data: bytes) -> None:
    _append_numbers(message, 'I', len(data))
    message += data


def _append_numbers(message: bytearray, code: str, *numbers: Any) -> None:
    message += bytes((len(ENCAPSULATION) - len(message)) % SIZES[code])
    message += struct.pack(f'<{len(numbers)}{code}', *numbers)
