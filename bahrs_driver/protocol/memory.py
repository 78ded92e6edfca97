# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The readable memory of a device: its size, and the blocks of its image."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple


@dataclass(frozen=True, slots=True)
class MemoryBlock:
    """A block of an image; its fields describe themselves with `layout.wire`."""

    NAME: ClassVar[str]
    CHECKED: ClassVar[bool] = True      # a CRC-32 follows


class FoundBlock(NamedTuple):
    """A block of an image, and whether its CRC is right; None if it has none."""

    block: MemoryBlock
    intact: bool | None


@dataclass(frozen=True)
class MemoryFormat:
    """The pages of a memory, and how to parse an image of them."""

    page_count: int
    page_size: int
    parse: Callable[[bytes], Iterable[FoundBlock]]      # ValueError for an image that is too short
    complain: Callable[[Sequence[FoundBlock]], str]     # about blocks of an unknown format

    @property
    def size(self) -> int:
        """Size of the memory in bytes."""
        return self.page_count * self.page_size
