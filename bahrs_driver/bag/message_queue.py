# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Queue messages from the thread that receives them to the one that writes them."""

from collections import deque
import threading
from typing import NamedTuple

MAX_BYTES = 256 * 1024 ** 2     # in the queue while a disk is slow: minutes of all topics
OVERHEAD = 200                  # bytes of memory for a message, beside its data


class RecordedMessage(NamedTuple):
    """A serialized message with its times in ns."""

    log_time: int
    topic: str
    data: bytes
    publish_time: int


class MessageQueue:
    """A queue that drops messages when it holds too many bytes."""

    def __init__(self, max_bytes: int = MAX_BYTES) -> None:
        self.dropped = 0            # messages for which there was no room
        self._max_bytes = max_bytes
        self._lock = threading.Lock()
        self._items: deque[RecordedMessage] = deque()
        self._bytes = 0

    def put(self, item: RecordedMessage) -> None:
        """Append a message, or count it as dropped."""
        size = len(item.data) + OVERHEAD
        with self._lock:
            if self._bytes + size > self._max_bytes:
                self.dropped += 1
                return
            self._bytes += size
            self._items.append(item)

    def take_all(self) -> list[RecordedMessage]:
        """Remove and return all messages."""
        with self._lock:
            items, self._items, self._bytes = self._items, deque(), 0
        return list(items)
