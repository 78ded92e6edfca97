# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write messages in the order of their log times."""

import heapq

from bahrs_driver.reprocess.topic_writers import TopicWriter
from bahrs_driver.units import NS_PER_S

LONGEST_DELAY = 10 * NS_PER_S   # from the log time of a message to the read that completes it
MOST_HELD = 50_000              # messages; ten times those of LONGEST_DELAY


class LogOrder:
    """Holds messages until no earlier one can follow, then writes them."""

    def __init__(self, writer: TopicWriter) -> None:
        self.count = 0                  # of messages
        self.first_ns = self.last_ns = 0        # log times
        self._writer = writer
        self._heap: list[tuple[int, int, str, object]] = []

    def add(self, log_ns: int, topic: str, message: object) -> None:
        """Hold a message. Those of equal log times keep their order."""
        heapq.heappush(self._heap, (log_ns, self.count, topic, message))
        self.count += 1

    def write_until(self, now: int) -> None:
        """Write the messages that no message after now, a log time, can precede."""
        heap, due = self._heap, now - LONGEST_DELAY
        while heap and (heap[0][0] <= due or len(heap) > MOST_HELD):
            self._write_first()

    def write_all(self) -> None:
        """Write all messages."""
        while self._heap:
            self._write_first()

    def _write_first(self) -> None:
        log_ns, _, topic, message = heapq.heappop(self._heap)
        self.first_ns = self.first_ns or max(0, log_ns)
        self.last_ns = max(log_ns, self.last_ns)
        self._writer.write(topic, self.last_ns, message)
