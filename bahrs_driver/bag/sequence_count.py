# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Count messages that were published and not received, by the sequence numbers of publishers.

A publisher counts its messages from 1. A gap between two received messages is a loss. Messages
before the first received one were published before the middleware had connected publisher and
recorder. If the driver was started first, recording begins there. If the recorder was, it has
missed them. No message has the time when its publisher was created, but the rate of messages
gives an estimate of when the first one was published.
"""

from collections.abc import Callable, Mapping

MIN_MESSAGES = 10                   # that show the rate of a topic
TOLERANCE = 0.1                     # share by which the rate may have been different before
SLACK = 300_000_000                 # ns from the creation of a topic to its first message


class SequenceCount:
    """Counts the messages of one topic; shared returns whether it has several publishers."""

    def __init__(self, shared: Callable[[], bool]) -> None:
        self.lost = 0                   # between received messages
        self.missed_again = 0           # of a restarted driver, before its first received one
        self.earlier = 0                # before the first received message
        self.span = 0                   # since then, of the same publisher
        self._shared = shared
        self._first_ns = self._last_ns = 0
        self._last = 0
        self._same = True

    def add(self, sequence: int, time_ns: int) -> None:
        """Count a received message, by its sequence number and log time in ns."""
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
        """Return an estimate of the time of the first message, in ns, and its uncertainty."""
        if self.earlier and self.span < MIN_MESSAGES:
            return None
        age = self.earlier * (self._last_ns - self._first_ns) / max(1, self.span)
        return self._first_ns - age, SLACK + TOLERANCE * age


def missed(counts: Mapping[str, SequenceCount], listening_since: int,
           is_new: bool) -> dict[str, int]:
    """
    Return, by topic, the number of messages published before recorder and driver were connected.

    is_new means that the driver certainly started after the recorder, whose log time that is.
    Messages of a driver that started earlier are not counted.
    """
    known = [(count.earlier + count.span, found)
             for count in counts.values() if (found := count.began()) is not None]
    if known and not is_new:
        _, (began, error) = max(known)
        is_new = began > listening_since - error
    numbers = {topic: count.missed_again + count.earlier * is_new
               for topic, count in counts.items()}
    return {topic: number for topic, number in numbers.items() if number}
