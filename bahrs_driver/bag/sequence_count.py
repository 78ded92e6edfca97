# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What was published and never came, by the sequence numbers of publishers.

A publisher counts its messages from 1. A gap between two that came is a loss. Messages before the
first one that came were published before the middleware had brought publisher and recorder
together. If the driver was started first, recording begins there. If the recorder was, it has
missed them. No message says when its publisher was made, but the rate at which messages come
tells about when the first one was published.
"""

from collections.abc import Callable, Mapping

LEAST = 10                          # messages that show the rate of a topic
TOLERANCE = 0.1                     # by which the rate may have been another one before
SLACK = 300_000_000                 # ns; a topic may be made some time before its first message


class SequenceCount:
    """Counts the messages of one topic. Times are log times in ns."""

    def __init__(self, shared: Callable[[], bool]) -> None:
        """Begin without a message; shared() returns whether several publishers send them."""
        self.lost = 0                   # between messages that came
        self.missed_again = 0           # of a driver that was started again, before its first
        self.earlier = 0                # before the first message that came
        self.span = 0                   # from then on, of the same publisher
        self._shared = shared
        self._first_ns = self._last_ns = 0
        self._last = 0
        self._same = True

    def add(self, sequence: int, time_ns: int) -> None:
        """Count a message that came, by its sequence number."""
        if not self._last:
            self.earlier = 0 if self._shared() else sequence - 1
            self._first_ns = time_ns
        elif sequence != self._last + 1 and not self._shared():
            if sequence > self._last:
                self.lost += sequence - self._last - 1
            else:
                self.missed_again += sequence - 1
                self._same = False
        if self._same:
            self.span += max(0, sequence - self._last) if self._last else 0
            self._last_ns = time_ns
        self._last = sequence

    def began(self) -> tuple[float, float] | None:
        """Return about when the first message was published, and by how much that may be wrong."""
        if self.earlier and self.span < LEAST:
            return None
        age = self.earlier * (self._last_ns - self._first_ns) / max(1, self.span)
        return self._first_ns - age, SLACK + TOLERANCE * age


def missed(counts: Mapping[str, SequenceCount], listening_since: int,
           is_new: bool) -> dict[str, int]:
    """
    Return, by topic, how many messages were published before recorder and driver were connected.

    is_new says that the driver certainly was not there when the recorder began, at a log time.
    What a driver published that had begun before that is not counted.
    """
    known = [(count.earlier + count.span, found)
             for count in counts.values() if (found := count.began()) is not None]
    if known and not is_new:
        _, (began, error) = max(known)
        is_new = began > listening_since - error
    numbers = {topic: count.missed_again + count.earlier * is_new
               for topic, count in counts.items()}
    return {topic: number for topic, number in numbers.items() if number}
