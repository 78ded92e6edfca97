# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a pipeline whose messages need no time."""

from collections.abc import Iterable

from bahrs_driver.clock.interface import Clock, Stamped, TimeState
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message


class Unstamped(Clock):
    """Return each message at once, with a stamp of 0."""

    def stamp(self, messages: Iterable[tuple[Message, Frame]]) -> list[Stamped]:
        """Return all messages, with a stamp of 0."""
        return [Stamped(message, frame, 0) for message, frame in messages]

    def state(self) -> TimeState:
        """Return the state of a clock without time."""
        return TimeState('none', 'none')
