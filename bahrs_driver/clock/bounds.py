# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Upper bounds of the time at which a frame began, from the reads that brought its bytes.

A frame began to leave the device before any of it could be read. If P bytes of the stream had
been received by a read at time t, and the first byte of a frame is at offset o < P, then that
byte began to leave at the latest at

    t - (P - o) * byte time

Each read that brought a part of the frame gives such a bound, including a read that brought only
its beginning: the adapter was then read in the middle of the frame, with little delay. The
smallest bound is used. As t - P * byte time does not depend on the frame, a read is forgotten as
soon as a later one has a smaller or equal value.
"""

from collections import deque

MAX_READS = 64      # remembered; after more reads, bounds are still true, but less tight


class ByteBounds:
    """Bounds of the times at which the bytes of a stream left the device."""

    def __init__(self, byte_time: int) -> None:
        """Begin a stream on a line that transmits a byte in byte_time ns."""
        self._byte_time = byte_time
        self._reads: deque[tuple[int, int]] = deque(maxlen=MAX_READS)   # received, t - P * time

    def observe_read(self, time: int, received: int) -> None:
        """Record the time of a read, and the bytes of the stream received by then."""
        reads, start = self._reads, time - received * self._byte_time
        while reads and reads[-1][1] >= start:
            reads.pop()
        reads.append((received, start))

    def bound(self, offset: int) -> int:
        """
        Return the latest time at which the byte at an offset can have begun to leave the device.

        Offsets must ascend from call to call, and be those of received bytes.
        """
        reads = self._reads
        while reads[0][0] <= offset:
            reads.popleft()
        return reads[0][1] + offset * self._byte_time
