# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time on host time.

For now a frame is stamped with the time its first byte left the device, as the host can tell it
from a single read: the time of the read, less the time that the bytes from the frame's first
to the chunk's last took on the line. What the adapter and the host hold back is still in it.
"""

NANOSECONDS = 1_000_000_000
BITS_PER_BYTE = 10                      # 8N1: start bit, eight data bits, stop bit


def byte_time_ns(baud_rate: int) -> int:
    """Return how long a byte takes on the line, in nanoseconds; 0 for a line without a rate."""
    return BITS_PER_BYTE * NANOSECONDS // baud_rate if baud_rate else 0


class ArrivalClock:
    """
    Stamps frames with their arrival, less their time on the line.

    Two chunks read in quick succession may put their frames in the wrong order; a stamp is
    therefore at least one nanosecond after the one before. Only a host clock that was set back
    by more than a second is followed backward.
    """

    _SET_BACK = NANOSECONDS

    def __init__(self, byte_time: int) -> None:
        """Take the time of one byte on the line, in nanoseconds."""
        self._byte_time = byte_time
        self._last = 0

    def stamp(self, read_time: int, bytes_since: int) -> int:
        """
        Return the stamp of a frame, in nanoseconds since the epoch.

        read_time is the host's time at the read that completed the frame, bytes_since the number
        of bytes from the frame's first to the last of that read.
        """
        stamp = read_time - bytes_since * self._byte_time
        if self._last - self._SET_BACK < stamp <= self._last:
            stamp = self._last + 1
        self._last = stamp
        return stamp
