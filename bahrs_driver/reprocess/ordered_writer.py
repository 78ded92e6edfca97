# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write messages in the order of their log times."""

import math

from bahrs_driver.bag.reorder_buffer import ReorderBuffer
from bahrs_driver.convert.outgoing import Values
from bahrs_driver.reprocess.topic_writer import TopicWriter
from bahrs_driver.units import NS_PER_S

LONGEST_DELAY = 10 * NS_PER_S   # from the log time of a message to the read that completes it
MOST_HELD = 50_000              # messages; ten times those of LONGEST_DELAY


class OrderedWriter:
    """Holds messages until no earlier one can follow, then writes them."""

    def __init__(self, writer: TopicWriter) -> None:
        self.first_ns = self.last_ns = 0        # log times of written messages
        self._writer = writer
        self._held = ReorderBuffer[tuple[str, Values]](MOST_HELD)

    @property
    def count(self) -> int:
        """Messages added so far."""
        return self._held.count

    def add(self, log_ns: int, topic: str, message: Values) -> None:
        """Hold a message. Those of equal log times keep their order."""
        self._held.add(log_ns, (topic, message))

    def write_until(self, now: float = math.inf) -> None:
        """Write the messages that no message after now, a log time, can precede."""
        for log_ns, (topic, message) in self._held.pop_until(now - LONGEST_DELAY):
            self.first_ns = self.first_ns or log_ns
            self.last_ns = log_ns
            self._writer.write(topic, log_ns, message)
