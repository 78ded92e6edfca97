# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Decoding of Titan-M payloads, whose byte order the document does not state.

Decoded in the wrong order, most numbers become values that no aircraft has: 1.0 becomes 4.6e-41.
Each number that is plausible in one order only is a vote for it. The order is known, and kept,
when it leads by enough votes; one ordinary answer has more than that. Zeros, and numbers that are
plausible in both orders, do not vote. Answers that arrive earlier are held, with their stamps,
and decoded in stream order when the order is known.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import fields
from typing import Generic

from bahrs_driver.protocol.decoder import ItemT
from bahrs_driver.protocol.titan_m.frames import Answer, OrderChoice
from bahrs_driver.protocol.titan_m.messages import ByteOrder, LAYOUTS, STRUCT_ORDERS, TitanAnswer

ENOUGH = 4              # votes by which one order must lead
MAX_HELD = 1000         # answers, about ten seconds
SMALLEST = 1e-9         # smaller magnitudes, except zero, are implausible

# Plausible ranges; every value of any other field is plausible.
LIMITS = {
    'position_ned': (-1e6, 1e6), 'velocity_ned': (-1e3, 1e3), 'attitude': (-7.0, 7.0),
    'angular_rate': (-100.0, 100.0), 'acceleration': (-1e3, 1e3),
    'gps_time_s': (0.0, 604_800.0), 'easting': (0.0, 1e6), 'northing': (0.0, 1e7),
    'altitude': (-1e3, 5e4), 'heading_deg': (-360.0, 360.0), 'speed': (0.0, 1e3),
    'ground_speed': (0.0, 1e3), 'temperature_c': (-60.0, 125.0),
    'absolute_pressure': (0.0, 2e5)}


def decode_payload(answer: Answer, order: ByteOrder) -> TitanAnswer:
    """Return the values of an answer, decoded in a byte order."""
    return LAYOUTS[answer.kind, order].decode(answer.payload)


def little_endian_lead(answer: Answer) -> int:
    """Return by how many votes little-endian leads; negative if big-endian leads."""
    little, big = (sum(_plausible(decode_payload(answer, order))) for order in STRUCT_ORDERS)
    return little - big


def _plausible(message: TitanAnswer) -> Iterator[bool]:
    for item in fields(message):
        limits = LIMITS.get(item.name)
        if limits:
            value = getattr(message, item.name)
            for number in value if isinstance(value, tuple) else (value,):
                yield not number or (
                    SMALLEST <= abs(number) and limits[0] <= number <= limits[1])


class PayloadDecoder(Generic[ItemT]):
    """
    Decodes the payloads of answers, and holds those that arrive before the byte order is known.

    `dropped` counts answers that were held for too long, `released` those that were delivered
    as values after they had been delivered undecoded.
    """

    def __init__(self, order: OrderChoice = 'auto', max_held: int | None = MAX_HELD) -> None:
        self._forced = order
        self._held: deque[tuple[ItemT, Answer]] = deque(maxlen=max_held)
        self.dropped = self.released = 0
        self.reset()

    def reset(self) -> None:
        """Forget the order: another device may be on the line."""
        self.order: ByteOrder | None = None if self._forced == 'auto' else self._forced
        self.contradicted = False       # whether the last answer that voted contradicts the order
        self._lead = 0
        self._held.clear()

    @property
    def held(self) -> int:
        """Count of answers that wait for the order."""
        return len(self._held)

    def resolve(self, item: ItemT) -> list[ItemT]:
        """
        Decode an answer, and release the answers held before it.

        While the order is unknown, an answer is returned undecoded and held, to be returned again
        as values. An unexpected answer is never decoded.
        """
        answer = item.message
        if not isinstance(answer, Answer) or not answer.expected:
            return [item]
        lead = little_endian_lead(answer)
        if self.order:
            if abs(lead) >= ENOUGH:
                self.contradicted = _leader(lead) != self.order
            return [item._replace(message=decode_payload(answer, self.order))]
        return self._hold(item, answer, lead)

    def _hold(self, item: ItemT, answer: Answer, lead: int) -> list[ItemT]:
        self.dropped += len(self._held) == self._held.maxlen
        self._held.append((item, answer))
        self._lead += lead
        if abs(self._lead) < ENOUGH:
            return [item]
        self.order = _leader(self._lead)
        released = [held._replace(message=decode_payload(held_answer, self.order))
                    for held, held_answer in self._held]
        self.released += len(released) - 1
        self._held.clear()
        return released


def _leader(lead: int) -> ByteOrder:
    return 'little' if lead > 0 else 'big'
