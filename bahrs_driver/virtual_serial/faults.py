# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Random transmission faults, by rate and seeded."""

from collections import Counter
from collections.abc import Callable, Mapping
import math
import random

from bahrs_driver.process.text_values import known, number

# Kinds of faults; rates are per byte or per frame.
NAMES = {
    'bit_flip': 'bytes with one bit inverted',
    'drop_byte': 'bytes lost',
    'repeat_byte': 'bytes sent twice',
    'insert_byte': 'bytes of noise inserted after a byte',
    'break': 'frames truncated',
    'drop_frame': 'frames lost',
    'repeat_frame': 'frames sent twice',
}


def parse_fault(text: str) -> tuple[str, float]:
    """Parse the name and rate of a fault, such as bit_flip=0.001."""
    name, _, rate = text.partition('=')
    known(name, 'fault', NAMES)
    return name, number(rate, f'the rate of {name}', 0, 1)


class Faults:
    """
    Damages frames.

    Each kind of fault has its own random sequence: changing the rate of one does not move the
    others. `counts` counts the faults so far.
    """

    def __init__(self, seed: int, rates: Mapping[str, float] | None = None) -> None:
        """Set rates by name, from 0 (never) to 1 (always)."""
        self.counts: Counter[str] = Counter()
        self._random = {name: random.Random(f'{name} {seed}') for name in NAMES}
        self._rates = dict.fromkeys(NAMES, 0.0)
        self._active = False
        self._distance = dict.fromkeys(NAMES, math.inf)     # bytes or frames until the next fault
        for name, rate in (rates or {}).items():
            self.set_rate(name, rate)

    def set_rate(self, name: str, rate: float) -> None:
        """Set the rate of a fault from the next frame on."""
        self._rates[name] = rate
        self._active = any(self._rates.values())
        self._distance[name] = self._draw(name)

    def apply(self, frame: bytes) -> bytes:
        """Return the bytes that arrive when a frame is sent."""
        if not self._active:
            return frame
        if self._hits('drop_frame', 1):
            return b''
        for name, damage in _DAMAGES.items():
            # From the end, because a fault moves the bytes behind it.
            for index in reversed(self._hits(name, len(frame))):
                frame = damage(frame, index, self._random[name])
        if self._hits('break', 1):
            frame = frame[:self._random['break'].randrange(1, max(2, len(frame)))]
        return frame * 2 if self._hits('repeat_frame', 1) else frame

    def _hits(self, name: str, length: int) -> list[int]:
        """Return the indices of faults among the next bytes or frames, and count them."""
        found = []
        distance = self._distance[name]
        while distance < length:
            found.append(int(distance))
            distance += 1 + self._draw(name)
        self._distance[name] = distance - length
        if found:
            self.counts[name] += len(found)
        return found

    def _draw(self, name: str) -> float:
        """Draw the number of bytes or frames until the next fault."""
        rate = self._rates[name]
        if not rate:
            return math.inf
        if rate == 1:
            return 0
        return math.floor(math.log(1 - self._random[name].random()) / math.log1p(-rate))


def _flip(frame: bytes, index: int, source: random.Random) -> bytes:
    return _replace(frame, index, bytes([frame[index] ^ 1 << source.randrange(8)]))


def _drop(frame: bytes, index: int, _source: random.Random) -> bytes:
    return _replace(frame, index, b'')


def _repeat(frame: bytes, index: int, _source: random.Random) -> bytes:
    return _replace(frame, index, frame[index:index + 1] * 2)


def _insert(frame: bytes, index: int, source: random.Random) -> bytes:
    return _replace(frame, index, frame[index:index + 1] + bytes([source.randrange(256)]))


def _replace(frame: bytes, index: int, instead: bytes) -> bytes:
    return frame[:index] + instead + frame[index + 1:]


_DAMAGES: dict[str, Callable[[bytes, int, random.Random], bytes]] = {
    'bit_flip': _flip, 'drop_byte': _drop, 'repeat_byte': _repeat, 'insert_byte': _insert}
