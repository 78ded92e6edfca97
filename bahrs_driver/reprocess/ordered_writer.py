# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write messages in the order of their log times."""

from collections.abc import Iterable
import math
from typing import Any

from bahrs_driver.bag.reorder_buffer import ReorderBuffer
from bahrs_driver.reprocess.topic_writer import LoggedValues, TopicWriter
from bahrs_driver.units import NS_PER_S

LONGEST_DELAY = 10 * NS_PER_S   # ns from the log time of a message to the read that completes it
MOST_HELD = 50_000              # messages, about; five times those of LONGEST_DELAY
WRITTEN_AT_ONCE = 5_000         # messages, about


class OrderedWriter:
    """Holds messages until no earlier one can follow, then writes them."""

    def __init__(self, writer: TopicWriter) -> None:
        self.count = 0                          # messages written
        self.first_ns = self.last_ns = 0        # their log times
        self._writer = writer
        self._held = ReorderBuffer[Any](MOST_HELD)
        self._enough = WRITTEN_AT_ONCE          # messages held, for some to be written

    def add(self, messages: Iterable[LoggedValues]) -> None:
        """Hold messages. Those of equal log times keep their order."""
        self._held.add(self._writer.prepare(messages))

    def write_until(self, now: int) -> None:
        """
        Write the messages that none after now can precede, if many are held.

        now is the log time of a read, in ns.
        """
        if len(self._held) >= self._enough:
            self._write(now - LONGEST_DELAY)
            self._enough = len(self._held) + WRITTEN_AT_ONCE

    def write_all(self) -> None:
        """Write the remaining messages."""
        self._write(math.inf)

    def _write(self, until: float) -> None:
        messages = self._held.pop_until(until)
        if messages:
            if not self.count:
                self.first_ns = messages[0][0]
            self.count += len(messages)
            self.last_ns = messages[-1][0]
            self._writer.write(messages)
