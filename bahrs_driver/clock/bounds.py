# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What reads say of when a frame began.

A frame has begun to leave the device before it can be read. If P bytes of the stream had come by
a read at time t, and a frame's first byte is the one at offset o < P, then that byte began to
leave at the latest at

    t - (P - o) * byte time

Each read that saw a part of the frame gives such a bound, also one that saw but its beginning:
the adapter was interrupted in the middle of the frame, and so was hardly late with it. The
smallest bound counts. As t - P * byte time is the same for all frames, only reads that are
the earliest by that measure from some point on need be remembered.
"""

from collections import deque

LONGEST = 64        # reads remembered; beyond, bounds are less tight and still true


class ByteBounds:
    """The reads of a stream, and what they say of a byte."""

    def __init__(self, byte_time: int) -> None:
        """Take the time of one byte on the line, in ns."""
        self._byte_time = byte_time
        self._reads: deque[tuple[int, int]] = deque(maxlen=LONGEST)     # received, t - P * time

    def read(self, time: int, received: int) -> None:
        """Take the time of a read, and how many bytes of the stream there were with it."""
        reads, start = self._reads, time - received * self._byte_time
        while reads and reads[-1][1] >= start:
            reads.pop()
        reads.append((received, start))

    def bound(self, offset: int) -> int:
        """
        Return the latest time at which the byte at an offset can have begun to leave the device.

        Offsets must ascend from call to call, and be of bytes that were read.
        """
        reads = self._reads
        while reads[0][0] <= offset:
            reads.popleft()
        return reads[0][1] + offset * self._byte_time
