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
from typing import NamedTuple

MIN_MESSAGES = 10                   # that show the rate of a topic
TOLERANCE = 0.1                     # share by which the rate may have been different before
SLACK = 300_000_000                 # ns from the creation of a topic to its first message


class PublisherStart(NamedTuple):
    """An estimate of when a publisher was created."""

    messages: int       # that it has published since
    time: float         # log time in ns
    error: float        # ns


class SequenceCount:
    """Counts the messages of one topic; shared returns whether it has several publishers."""

    def __init__(self, shared: Callable[[], bool]) -> None:
        self.lost = 0                   # between received messages
        self.before_first = 0           # published before the first received message
        self.before_restarted = 0       # the same of a restarted driver
        self._shared = shared
        self._last = 0
        # The first publisher, from its first received message to its latest one:
        self._published = 0             # messages
        self._first_ns = self._last_ns = 0
        self._restarted = False

    def add(self, sequence: int, time_ns: int) -> None:
        """Count a received message, by its sequence number and log time in ns."""
        if not self._last:
            self.before_first = 0 if self._shared() else sequence - 1
            self._last, self._first_ns = sequence, time_ns
        elif sequence != self._last + 1 and not self._shared():
            if sequence > self._last:
                self.lost += sequence - self._last - 1
            else:
                self.before_restarted += sequence - 1
                self._restarted = True
        if not self._restarted:
            self._published += max(0, sequence - self._last)
            self._last_ns = time_ns
        self._last = sequence

    def start(self) -> PublisherStart | None:
        """Estimate when the publisher was created; None if too few messages show the rate."""
        if self.before_first and self._published < MIN_MESSAGES:
            return None
        period = (self._last_ns - self._first_ns) / max(1, self._published)
        age = self.before_first * period
        return PublisherStart(self.before_first + self._published, self._first_ns - age,
                              SLACK + TOLERANCE * age)


def missed(counts: Mapping[str, SequenceCount], recorder_start: int,
           driver_is_later: bool) -> dict[str, int]:
    """
    Return, by topic, the number of messages published before recorder and driver were connected.

    recorder_start is a log time; driver_is_later means that the driver certainly started after
    it. Messages of a driver that started earlier are not counted.
    """
    starts = [start for count in counts.values() if (start := count.start()) is not None]
    if starts and not driver_is_later:
        best = max(starts)              # of the topic with most messages
        driver_is_later = best.time > recorder_start - best.error
    numbers = {topic: count.before_restarted + count.before_first * driver_is_later
               for topic, count in counts.items()}
    return {topic: number for topic, number in numbers.items() if number}
