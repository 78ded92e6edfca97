# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Make the function that decodes one message from the rows of its fields.

It takes most of the time of a stream, so it does as little as possible for each field. Rows of
the same kind are decoded by one loop, without a call for each. Fields are set through their slots:
the constructor of a frozen class takes twice as long.
"""

from collections.abc import Callable, Sequence
import struct
from typing import Any, TypeVar

from bahrs_driver.protocol.row import Row

Message = TypeVar('Message')
_Setter = Callable[[Any, Any], None]


class _Fields:
    """For each field: how to set it, the index of its raw number or of each, its conversion."""

    def __init__(self, kind: type[Any], rows: Sequence[tuple[str, Row]]) -> None:
        self.plain: list[tuple[_Setter, int | slice]] = []
        self.scaled: list[tuple[_Setter, int, float, float]] = []
        self.vectors: list[tuple[_Setter, int, int, int, float]] = []
        self.converted: list[tuple[_Setter, int, Callable[[Any], Any]]] = []
        index = 0
        for name, row in rows:
            self._add(getattr(kind, name).__set__, row, index)
            index += row.count

    def _add(self, set_field: _Setter, row: Row, i: int) -> None:
        if row.decode:
            self.converted.append((set_field, i, row.decode))
        elif row.scale is None:
            self.plain.append((set_field, i if row.count == 1 else slice(i, i + row.count)))
        elif row.count == 1:
            self.scaled.append((set_field, i, row.scale, row.offset))
        else:
            self.vectors.append((set_field, i, i + 1, i + 2, row.scale))


def message_decoder(kind: type[Message], rows: Sequence[tuple[str, Row]],
                    packer: struct.Struct) -> Callable[..., Message]:
    """Return a function of bytes, and of the place at which the payload starts (0)."""
    assert not hasattr(kind, '__post_init__'), 'no constructor is called'
    fields = _Fields(kind, rows)
    plain, scaled = fields.plain, fields.scaled
    vectors, converted = fields.vectors, fields.converted
    unpack, new = packer.unpack_from, object.__new__

    def decode(payload: bytes, start: int = 0) -> Message:
        raw: tuple[Any, ...] = unpack(payload, start)
        message = new(kind)
        for set_field, i in plain:
            set_field(message, raw[i])
        for set_field, i, scale, offset in scaled:
            set_field(message, raw[i] * scale + offset)
        for set_field, x, y, z, scale in vectors:
            set_field(message, (raw[x] * scale, raw[y] * scale, raw[z] * scale))
        for set_field, i, convert in converted:
            set_field(message, convert(raw[i]))
        return message

    return decode
