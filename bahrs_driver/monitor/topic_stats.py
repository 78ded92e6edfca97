# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Statistics of the messages on one topic."""

from collections import deque
import math
import time

RATE_WINDOW = 2.0           # s
MAX_ARRIVALS = 4096         # a rate above 2 kHz is measured over less than the window


class TopicStats:
    """Count, rate and latest message of one topic."""

    def __init__(self) -> None:
        self.count = 0
        self.data = b''             # the latest message, serialized
        self._arrivals: deque[float] = deque(maxlen=MAX_ARRIVALS)

    def add(self, data: bytes) -> None:
        """Count a message and keep it."""
        self.count += 1
        self.data = data
        self._arrivals.append(time.monotonic())
        self._drop_old(self._arrivals[-1])

    @property
    def age(self) -> float:
        """Seconds since the latest message; infinite if it is not in the window any more."""
        return time.monotonic() - self._arrivals[-1] if self._arrivals else math.inf

    def rate(self) -> float:
        """Return messages per second over the last RATE_WINDOW."""
        self._drop_old(time.monotonic())
        if len(self._arrivals) < 2 or self._arrivals[-1] == self._arrivals[0]:
            return 0.0
        return (len(self._arrivals) - 1) / (self._arrivals[-1] - self._arrivals[0])

    def _drop_old(self, now: float) -> None:
        while self._arrivals and now - self._arrivals[0] > RATE_WINDOW:
            self._arrivals.popleft()
