# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Count lost messages by their sequence numbers, or by the requests without answer."""

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from bahrs_driver.protocol.message import Message

from bahrs_driver.units import COUNTER_MODULUS


class LossCounter(Protocol):
    """Counts lost messages, by the name of the message."""

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start."""

    def observe(self, message: Message, stream_time: float, rate: float) -> None:
        """Count a message at a time of the stream in s, without pauses; its rate is in Hz."""

    def restart(self) -> None:
        """Ignore the gap before the next message."""


class SequenceLosses:
    """Counts the gaps in sequence numbers."""

    def __init__(self) -> None:
        self.lost = Counter[str]()
        self._last: dict[str, tuple[int, float]] = {}

    def observe(self, message: Any, stream_time: float, rate: float) -> None:
        """Count a message at a time of the stream in s, without pauses; its rate is in Hz."""
        name, sequence, last = message.NAME, message.sequence, self._last.get(message.NAME)
        self._last[name] = sequence, stream_time
        if last and (sequence != (last[0] + 1) % COUNTER_MODULUS
                     or (stream_time - last[1]) * rate > COUNTER_MODULUS / 2):
            self.lost[name] += missing(*last, sequence, stream_time, rate)

    def restart(self) -> None:
        """Ignore the gap before the next message."""
        self._last.clear()


class RequestLosses:
    """Counts requests without answer as lost; get_lost returns their number by message."""

    def __init__(self, get_lost: Callable[[], Mapping[str, int]]) -> None:
        self._get_lost = get_lost

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start."""
        return self._get_lost()

    def observe(self, _message: Message, _stream_time: float, _rate: float) -> None:
        """Do nothing: an answer shows no gap."""

    def restart(self) -> None:
        """Do nothing: there are no gaps."""


def missing(last: int, then: float, sequence: int, now: float, rate: float) -> int:
    """
    Return how many messages are missing between two with these counters and times.

    The counters give the number modulo 256; the elapsed time (s) and the rate (Hz) give the number
    of wraps. A repeated message is not a loss.
    """
    gap = (sequence - last - 1) % COUNTER_MODULUS
    expected = (now - then) * rate - 1
    wraps = round((expected - gap) / COUNTER_MODULUS)
    return max(0, gap + COUNTER_MODULUS * wraps)
