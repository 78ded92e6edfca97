# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Make the function that encodes one message from the rows of its fields."""

from collections.abc import Callable, Sequence
from operator import attrgetter
import struct
from typing import Any

from bahrs_driver.protocol.row import Row


def message_encoder(rows: Sequence[tuple[str, Row]],
                    packer: struct.Struct) -> Callable[[Any], bytes]:
    """Return a function of a message. It raises the errors of conversions and of struct."""
    pack = packer.pack
    fields = [(attrgetter(name), row.encode, row.scale, row.offset, row.count)
              for name, row in rows]

    def encode(message: Any) -> bytes:
        raw: list[Any] = []
        for get, convert, scale, offset, count in fields:
            value = get(message)
            if count == 1:
                raw.append(convert(value) if convert else value if scale is None
                           else round((value - offset) / scale))
            elif scale is None:
                raw += value
            else:
                x, y, z = value
                raw += round(x / scale), round(y / scale), round(z / scale)
        return pack(*raw)

    return encode
