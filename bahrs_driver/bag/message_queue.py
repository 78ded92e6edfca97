# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Messages on their way from the thread that takes them to the one that writes them."""

from collections import deque
import threading
from typing import NamedTuple

MOST_BYTES = 256 * 1024 ** 2    # that wait while a disk is slow: minutes of all topics
OVERHEAD = 200                  # bytes of memory for a message, beside its data


class Taken(NamedTuple):
    """A message as it came. Times are in ns."""

    log_time: int
    topic: str
    data: bytes
    publish_time: int


class TakenQueue:
    """A queue that takes no more when its messages need too much memory."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        self.dropped = 0            # messages for which there was no room
        self._most_bytes = most_bytes
        self._lock = threading.Lock()
        self._items: deque[Taken] = deque()
        self._bytes = 0

    def put(self, item: Taken) -> None:
        """Append a message, or count it as dropped."""
        size = len(item.data) + OVERHEAD
        with self._lock:
            if self._bytes + size > self._most_bytes:
                self.dropped += 1
                return
            self._bytes += size
            self._items.append(item)

    def take_all(self) -> list[Taken]:
        """Return all messages, and keep none."""
        with self._lock:
            items, self._items, self._bytes = self._items, deque(), 0
        return list(items)
