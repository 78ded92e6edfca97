# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read a serialized message of raw bytes, std_msgs/UInt8MultiArray in CDR.

A recording has one for each read of the port. The library that reads messages of any type takes
six times as long.
"""

import struct

from bahrs_driver.bag.stored_message import RAW_TYPE
from bahrs_driver.errors import DamageError

# How to unpack a uint32, by the first two bytes of a message.
_UNPACK = {b'\0\0': struct.Struct('>I').unpack_from, b'\0\1': struct.Struct('<I').unpack_from}
_SIZE_AND_STRIDE = 8        # bytes


def read_raw(message: bytes) -> tuple[str | None, bytes]:
    """Return the first label of the layout, if it has one, and the data; DamageError."""
    if not message:
        raise DamageError('it is empty')
    try:
        label, begin, end = _read(message)
    except (KeyError, struct.error, UnicodeDecodeError) as error:
        raise _damaged() from error
    if not end <= len(message) < end + 4:       # there may be padding at the end
        raise _damaged()
    return label, message[begin:end]


def _read(message: bytes) -> tuple[str | None, int, int]:
    """Return the first label, and where the data begins and ends."""
    unpack, label = _UNPACK[message[:2]], None
    (dimensions,), position = unpack(message, 4), 8
    for dimension in range(dimensions):
        (size,) = unpack(message, position)
        position += 4
        if not dimension:
            label = message[position:position + size - 1].decode() if size else ''
        position += size
        position += -position % 4 + _SIZE_AND_STRIDE
    (size,) = unpack(message, position + 4)     # behind the offset of the data
    return label, position + 8, position + 8 + size


def _damaged() -> DamageError:
    return DamageError(f'it is cut, or not of type {RAW_TYPE}')
