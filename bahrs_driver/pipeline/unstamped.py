# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The clock of a pipeline whose messages need no time."""

from collections.abc import Iterable
from typing import Any

from bahrs_driver.clock.interface import Instant, Stamped, TimeState
from bahrs_driver.protocol.framing import Frame


class Unstamped:
    """Return each message at once, with a stamp of 0."""

    def begin(self, byte_time: int) -> None:
        """Do nothing: no state depends on the stream."""

    def observe_read(self, now: Instant, received: int) -> None:
        """Ignore the instant of a read."""

    def stamp(self, messages: Iterable[tuple[Any, Frame]]) -> list[Stamped]:
        """Return all messages, with a stamp of 0."""
        return [Stamped(message, frame, 0) for message, frame in messages]

    def end(self) -> list[Stamped]:
        """Return an empty list: no message waits."""
        return []

    def pulse_reference(self, _ros_ns: int) -> None:
        """Ignore the time of a sync pulse."""

    def take_notices(self) -> list[str]:
        """Return an empty list: no clock is watched."""
        return []

    def smoothing(self) -> None:
        """Return None: nothing is stamped."""

    def state(self) -> TimeState:
        """Return that nothing is stamped."""
        return TimeState('none', 'none')
