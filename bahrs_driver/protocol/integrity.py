# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The integrity of signals, and its encoding in health fields."""

from collections.abc import Callable
from enum import IntEnum
from functools import lru_cache

# Cached health words: a working device sends few of them, noise any of 65,536.
REMEMBERED = 256


class Integrity(IntEnum):
    """
    Integrity of a signal as reported by the device (section 2.4 of its document).

    RESERVED is the bit pattern that the document leaves undefined. It has a value of its own to be
    reported, and never counts as an available signal.
    """

    UNAVAILABLE = 0
    SAFE = 1
    INTEGRITY_RISK = 2
    RESERVED = 3

    @property
    def available(self) -> bool:
        """Whether the signal has a value: safe, or at integrity risk."""
        return self in (Integrity.SAFE, Integrity.INTEGRITY_RISK)

    @property
    def label(self) -> str:
        """Name in data: ``safe``, ``integrity_risk``, ..."""
        return self.name.lower()

    @property
    def words(self) -> str:
        """Name in sentences: ``safe``, ``integrity risk``, ..."""
        return self.label.replace('_', ' ')


Health = tuple[Integrity, ...]


def two_bit_fields(count: int) -> tuple[Callable[[int], Health], Callable[[Health], int]]:
    """Return the decoder and encoder of count two-bit fields, first signal lowest (version 3)."""

    @lru_cache(maxsize=REMEMBERED)
    def decode(word: int) -> Health:
        return tuple(Integrity(word >> 2 * i & 0b11) for i in range(count))

    @lru_cache(maxsize=REMEMBERED)
    def encode(health: Health) -> int:
        if len(health) != count:
            raise ValueError(f'{count} signals needed')
        return sum(integrity << 2 * i for i, integrity in enumerate(health))

    return decode, encode


def valid_bits(count: int) -> tuple[Callable[[int], Health], Callable[[Health], int]]:
    """
    Return the decoder and encoder of count valid bits, first signal lowest (versions 1 and 2).

    One bit cannot express an integrity risk: only a safe signal is encoded as valid.
    """

    @lru_cache(maxsize=REMEMBERED)
    def decode(bits: int) -> Health:
        return tuple(Integrity(bits >> i & 1) for i in range(count))

    @lru_cache(maxsize=REMEMBERED)
    def encode(health: Health) -> int:
        if len(health) != count:
            raise ValueError(f'{count} signals needed')
        return sum((integrity == Integrity.SAFE) << i for i, integrity in enumerate(health))

    return decode, encode
