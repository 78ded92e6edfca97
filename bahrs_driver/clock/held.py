# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Messages in the order of the stream, until the first of them can be stamped.

Samples are held until device time is known. What follows them in the stream is held with them,
whether or not it needs a time: an accuracy message speaks of the navigation messages behind it,
not of those before it, however the adapter cut the stream.
"""

from typing import Any

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.protocol.bahrs.messages import Inertial
from bahrs_driver.protocol.framing import Frame

LATE_KINDS = 2          # messages of all kinds for each sample that may be held


class Held:
    """A message on its way to a stamp."""

    __slots__ = ('bound', 'count', 'device', 'early', 'frame', 'message', 'near', 'timed', 'unfed')

    def __init__(self, message: Any, frame: Frame, bound: int) -> None:
        self.message = message
        self.frame = frame
        self.bound = bound
        self.timed = False                          # whether it has a time
        self.count: int | None = None               # of the sample that it is
        self.near: CountedSequence | None = None    # the sample before a navigation message
        self.early = False                          # that one was not received
        self.device: int | None = None              # the device time that it carries, in ns
        self.unfed = False                          # a sample that the tracker did not get yet


class HeldMessages:
    """A queue with a limit on how much of it may wait."""

    def __init__(self, most_samples: int) -> None:
        self._most_samples = most_samples
        self.items: list[Held] = []

    def __len__(self) -> int:
        """Return how many messages are held."""
        return len(self.items)

    def take_all(self) -> list[Held]:
        """Return all messages in order, and hold none of them any more."""
        items, self.items = self.items, []
        return items

    @property
    def timed(self) -> bool:
        """Whether a message that is about a time is among them."""
        return any(item.timed for item in self.items)

    @property
    def full(self) -> bool:
        """Whether more are held than may wait."""
        samples = sum(type(item.message) is Inertial for item in self.items)
        return samples > self._most_samples or len(self.items) > LATE_KINDS * self._most_samples
