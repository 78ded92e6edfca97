# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Messages in the order of the stream, held until the first of them can be stamped.

Samples are held until device time is known. Later messages are held as well, even if they need no
time: an accuracy message applies to the navigation messages after it, not to those before it, and
the order must not depend on where the adapter cuts the stream.
"""

from typing import Any

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.protocol.framing import Frame

MESSAGES_PER_SAMPLE = 2     # messages of all types that may be held


class Held:
    """A message before it has a stamp."""

    __slots__ = ('bound', 'count', 'device_time', 'frame', 'message', 'preceding',
                 'preceding_lost', 'timed', 'unfed')

    def __init__(self, message: Any, frame: Frame, bound: int) -> None:
        """Hold a message; bound is the latest raw time at which it was sent."""
        self.message = message
        self.frame = frame
        self.bound = bound
        self.timed = False                          # whether it has a time of its own
        self.count: int | None = None               # of a sample
        self.preceding: CountedSequence | None = None   # the sample before a navigation message
        self.preceding_lost = False                 # that sample was not received
        self.device_time: int | None = None         # in the message, in ns
        self.unfed = False                          # whether the estimate lacks this sample


class HeldMessages:
    """A bounded queue of held messages."""

    def __init__(self, sample: type, most_samples: int) -> None:
        """Limit the held messages of the type `sample`, and all messages to twice as many."""
        self._sample = sample
        self._most_samples = most_samples
        self.items: list[Held] = []

    def __len__(self) -> int:
        """Return the count of held messages."""
        return len(self.items)

    def take_all(self) -> list[Held]:
        """Remove and return all messages, in order."""
        items, self.items = self.items, []
        return items

    @property
    def timed(self) -> bool:
        """Whether a message with a time of its own is held."""
        return any(item.timed for item in self.items)

    @property
    def full(self) -> bool:
        """Whether a limit is exceeded."""
        samples = sum(type(item.message) is self._sample for item in self.items)
        return samples > self._most_samples or \
            len(self.items) > MESSAGES_PER_SAMPLE * self._most_samples
