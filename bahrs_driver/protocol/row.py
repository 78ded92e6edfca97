# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""One field of a message on the wire."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Conversion = Callable[[Any], Any]


@dataclass(frozen=True)
class Row:
    """
    One field on the wire: its struct code, its count of repetitions, and its conversion.

    With a scale, value = scale * raw + offset; a vector of three components has no offset. With
    `decode` and `encode`, these functions convert a field that is not repeated. Without either,
    the raw number is the value. `reserved` bytes follow it; they are ignored, and written as 0.
    """

    code: str
    count: int = 1
    unit: str = ''
    scale: float | None = None
    offset: float = 0.0
    decode: Conversion | None = None
    encode: Conversion | None = None
    reserved: int = 0

    def __post_init__(self) -> None:
        if self.scale is not None and self.count > 1:
            assert self.count == 3 and not self.offset, 'a vector'

    @property
    def wire_code(self) -> str:
        """Return the struct code of all repetitions and reserved bytes."""
        return (self.code if self.count == 1 else f'{self.count}{self.code}') + 'x' * self.reserved
