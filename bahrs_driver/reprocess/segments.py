# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Device time and ROS time by the count of a sample, linear in segments."""

from bisect import bisect_right
from typing import NamedTuple

MOST_SEGMENTS = 1000                # kept behind the sample that was last asked for


class Segment(NamedTuple):
    """Samples whose time is linear, up to the begin of the next segment."""

    begin: int              # count of its first sample
    sample: int             # count of a sample whose time is known
    time: int               # device time of that sample, in ns
    elapsed: int            # ns of so many samples
    samples: int
    offset: int = 0         # ROS time minus device time, in ns

    def time_of(self, count: int) -> int:
        """Return the device time of a sample."""
        return self.time + (count - self.sample) * self.elapsed // self.samples


class Segments:
    """The segments of a stream, in ascending order."""

    def __init__(self) -> None:
        self._items: list[Segment] = []
        self._begins: list[int] = []

    @property
    def first(self) -> Segment:
        """Segment of the first samples."""
        return self._items[0]

    @property
    def last(self) -> Segment:
        """Segment of the last samples."""
        return self._items[-1]

    def add(self, segment: Segment) -> None:
        """Append a segment."""
        self._items.append(segment)
        self._begins.append(segment.begin)

    def replace_last(self, segment: Segment) -> None:
        """Replace the last segment by another with the same begin."""
        self._items[-1] = segment

    def at(self, count: int) -> Segment:
        """Return the segment of a sample."""
        return self._items[max(0, bisect_right(self._begins, count) - 1)]

    def discard_before(self, count: int) -> None:
        """Discard the segments before that of a sample, once there are many."""
        passed = bisect_right(self._begins, count) - 1
        if passed > MOST_SEGMENTS:
            del self._items[:passed], self._begins[:passed]

    def latest_ros_time(self) -> int:
        """Return the latest ROS time of the known samples, in ns."""
        return max(segment.time + segment.offset for segment in self._items)

    def shift(self, offset: int) -> None:
        """Add an offset to ROS time, in ns."""
        self._items = [item._replace(offset=item.offset + offset) for item in self._items]
