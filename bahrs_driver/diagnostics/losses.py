# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""How many messages were lost: told by the counters that they carry, or by who asked for them."""

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from bahrs_driver.units import COUNTER_MODULUS


class Losses(Protocol):
    """Counts what was lost, by the name of the message."""

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start."""

    def observe(self, message: Any, flowing: float, rate: float) -> None:
        """Take a message, the seconds for which the stream has flowed, and its rate in Hz."""

    def restart(self) -> None:
        """Begin to count gaps afresh."""


class SequenceLosses:
    """Tells by the gaps in sequence numbers."""

    def __init__(self) -> None:
        self.lost = Counter[str]()
        self._last: dict[str, tuple[int, float]] = {}

    def observe(self, message: Any, flowing: float, rate: float) -> None:
        """Take a message, the seconds for which the stream has flowed, and its rate in Hz."""
        name, sequence = message.NAME, message.sequence
        self.lost[name] += missing(*self._last[name], sequence, flowing, rate) \
            if name in self._last else 0
        self._last[name] = sequence, flowing

    def restart(self) -> None:
        """Begin to count gaps afresh."""
        self._last.clear()


class RequestLosses:
    """Knows from somebody else."""

    def __init__(self, lost: Callable[[], Mapping[str, int]]) -> None:
        self._lost = lost

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start."""
        return self._lost()

    def observe(self, message: Any, flowing: float, rate: float) -> None:
        """Do nothing: a message that comes tells nothing of others."""

    def restart(self) -> None:
        """Do nothing: there are no gaps."""


def missing(last: int, then: float, sequence: int, now: float, rate: float) -> int:
    """
    Return how many messages came between two that have these counters and times.

    The counter alone tells it modulo 256; the time in between (s) and the rate (Hz) tell how
    often it went round. A repeated message is not a loss.
    """
    gap = (sequence - last - 1) % COUNTER_MODULUS
    expected = (now - then) * rate - 1
    turns = round((expected - gap) / COUNTER_MODULUS)
    return max(0, gap + COUNTER_MODULUS * turns)
