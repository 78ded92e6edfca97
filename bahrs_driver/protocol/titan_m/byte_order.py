# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
In which byte order a Titan-M puts its payloads, told by what its values can be.

Read in the wrong order, most numbers become ones that no aircraft has: 1.0 becomes 4.6e-41. Each
number that can be in one order and cannot in the other is a vote. The order is known, and stays,
once it is ahead by enough votes; one ordinary answer has more than that. Zeros, and what could
be either, tell nothing. Until then answers are held, in order, and are read when it is known.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import fields
from typing import Any, Generic, TypeVar

from bahrs_driver.protocol.titan_m.frames import OrderChoice
from bahrs_driver.protocol.titan_m.messages import ByteOrder, LAYOUTS, STRUCT_ORDERS, TitanAnswer

ENOUGH = 4              # votes ahead
MOST_HELD = 1000        # answers, some ten seconds
TINY = 1e-9             # what is smaller, and not zero, is none of these quantities

# What a value can be at all; a field that is not here can be anything in either order.
LIMITS = {
    'position_ned': (-1e6, 1e6), 'velocity_ned': (-1e3, 1e3), 'attitude': (-7.0, 7.0),
    'angular_rate': (-100.0, 100.0), 'acceleration': (-1e3, 1e3),
    'gps_time_s': (0.0, 604_800.0), 'easting': (0.0, 1e6), 'northing': (0.0, 1e7),
    'altitude': (-1e3, 5e4), 'heading_deg': (-360.0, 360.0), 'speed': (0.0, 1e3),
    'ground_speed': (0.0, 1e3), 'temperature_c': (-60.0, 125.0),
    'absolute_pressure': (0.0, 2e5)}

OTHER: dict[ByteOrder, ByteOrder] = {'little': 'big', 'big': 'little'}

Tag = TypeVar('Tag')


def read(kind: type[TitanAnswer], payload: bytes, order: ByteOrder) -> TitanAnswer:
    """Return the answer that a payload is, read in an order."""
    return LAYOUTS[kind, order].decode(payload)


def lead(kind: type[TitanAnswer], payload: bytes) -> int:
    """Return by how many votes little-endian is ahead; negative if it is behind."""
    little, big = (list(_possible(read(kind, payload, order))) for order in STRUCT_ORDERS)
    return sum(little) - sum(big)


def _possible(message: TitanAnswer) -> Iterator[bool]:
    for item in fields(message):  # type: ignore[arg-type]
        limits = LIMITS.get(item.name)
        if limits:
            value = getattr(message, item.name)
            for number in value if isinstance(value, tuple) else (value,):
                yield not number or (TINY <= abs(number) and limits[0] <= number <= limits[1])


class PayloadReader(Generic[Tag]):
    """Reads answers, each with whatever goes with it, once it is known how."""

    def __init__(self, order: OrderChoice = 'auto', most_held: int | None = MOST_HELD) -> None:
        self._forced = order
        self._held: deque[tuple[type[TitanAnswer], bytes, Tag]] = deque(maxlen=most_held)
        self.given_up = 0           # answers that were held for too long
        self.begin()

    def begin(self) -> None:
        """Forget what was seen: another device may be on the line."""
        self.order: ByteOrder | None = None if self._forced == 'auto' else self._forced
        self.doubted = False        # whether the last answer that told speaks against the order
        self._lead = 0
        self._held.clear()

    @property
    def held(self) -> int:
        """How many answers wait for the order."""
        return len(self._held)

    def read(self, kind: type[TitanAnswer], payload: bytes,
             tag: Tag) -> list[tuple[Any, Tag]]:
        """Take an answer; return those that can be read by now, in order, each with its tag."""
        votes = lead(kind, payload)
        if self.order:
            if abs(votes) >= ENOUGH:
                self.doubted = _order(votes) != self.order
            return [(read(kind, payload, self.order), tag)]
        self.given_up += len(self._held) == self._held.maxlen
        self._held.append((kind, payload, tag))
        self._lead += votes
        if abs(self._lead) < ENOUGH:
            return []
        self.order = _order(self._lead)
        waited = [(read(kind, payload, self.order), tag) for kind, payload, tag in self._held]
        self._held.clear()
        return waited


def _order(votes: int) -> ByteOrder:
    return 'little' if votes > 0 else 'big'
