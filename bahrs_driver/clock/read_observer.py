# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The reads of a stream: when they were, how many bytes they brought, and what that bounds."""

from collections import deque
from statistics import median_low

from bahrs_driver.clock.bounds import ByteBounds
from bahrs_driver.clock.host import HostClocks, step_sentence
from bahrs_driver.clock.interface import Instant
from bahrs_driver.clock.notices import Notices

CHUNKS = 99             # reads in the median of their sizes


class ReadObserver:
    """Observes the reads of a stream for a clock."""

    def __init__(self, notices: Notices) -> None:
        """Add steps of the host's clock to the notices."""
        self.host = HostClocks()
        self.now = Instant(0, 0)
        self.received = 0
        self._notices = notices
        self._chunks: deque[int] = deque(maxlen=CHUNKS)
        self.begin(0)

    def begin(self, byte_time: int) -> None:
        """Begin another stream, on a line that transmits a byte in byte_time ns."""
        self.bounds = ByteBounds(byte_time)

    def observe(self, now: Instant, received: int) -> bool:
        """Record a read; return whether the host's clock was set back before it."""
        self._chunks.append(received - self.received)
        self.now, self.received = now, received
        self.bounds.observe_read(now.raw_ns, received)
        step = self.host.observe_read(now)
        if step:
            self._notices.add(step_sentence(step))
        return step < 0

    @property
    def median_chunk(self) -> int:
        """Median of the bytes per read, 0 without a read."""
        return median_low(self._chunks) if self._chunks else 0
