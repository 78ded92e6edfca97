# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""One field of a message on the wire."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Row:
    """
    One field on the wire: its struct code, its count of repetitions, and its conversion.

    With a scale, value = scale * raw + offset for each repetition. With `decode` and `encode`,
    these functions convert a field that is not repeated. Without either, the raw number is the
    value. `reserved` bytes follow it. They are ignored, and written as zeros.
    """

    code: str
    count: int = 1
    unit: str = ''
    scale: float | None = None
    offset: float = 0.0
    decode: Callable[[Any], Any] | None = None
    encode: Callable[[Any], Any] | None = None
    reserved: int = 0

    @property
    def wire_code(self) -> str:
        """Return the struct code of all repetitions and reserved bytes."""
        return (self.code if self.count == 1 else f'{self.count}{self.code}') + 'x' * self.reserved
