# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The samples of a stream of bytes, counted by their counters, and the device times of some.

Samples are the inertial messages, or the navigation messages of a stream that has no others.
Both are counted in inertial periods. What comes before the first sample, or after the device was
switched on, belongs to the sample before the next one, which was sent and not received.
"""

from array import array
from collections import deque
from collections.abc import Iterator
from typing import Any

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.navigation import NavigationCounter, PER_NAVIGATION
from bahrs_driver.clock.time_reference import Label, TimeReferenceConvention
from bahrs_driver.protocol.bahrs.messages import (
    Inertial, InertialTime, Navigation, NavigationTime, SoftwareVersion, TimeMessage,
)
from bahrs_driver.reprocess.sample_times import Anchor, Jump, SampleTimes
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_US

DECIDING = 99                       # time messages, until it is decided what they name
MOST_EARLY = 1000                   # messages before a sample
LONGEST_TIME = 2 ** 62              # ns; beyond it a time is a mistake


class CountedStream:
    """Looks at all messages of a stream, and knows what ByteClock needs to stamp them."""

    def __init__(self, label: Label = 'auto',
                 kind: type[Inertial] | type[Navigation] = Inertial) -> None:
        self.kind = kind
        self.step = PER_NAVIGATION if kind is Navigation else 1     # counts a message
        self.times = SampleTimes()
        self.convention = TimeReferenceConvention(label, DECIDING)
        self.navigation = NavigationCounter()
        # Samples whose count does not go on by one: their number, from 0, count and counter.
        self._jumps = array('q'), array('q'), array('B')
        self.before: CountedSequence | None = None      # the sample before the first one
        self._latest: CountedSequence | None = None
        self._received = 0
        self._ahead: list[int] = []     # navigation messages before the first sample
        self._early: deque[Any] = deque(maxlen=MOST_EARLY)
        self._power_on = False
        # Time messages from before it is clear which sample they name.
        self._undecided: list[tuple[TimeMessage, CountedSequence, int]] | None = []

    @property
    def count(self) -> int:
        """Count of the latest sample; the first one has 0."""
        return self.step * (self._latest.count if self._latest else -1)

    def jumps(self) -> Iterator[tuple[int, CountedSequence]]:
        """Return which samples, numbered from 0, have a count that does not go on by one."""
        numbers, counts, sequences = self._jumps
        return ((number, CountedSequence(count, sequence))
                for number, count, sequence in zip(numbers, counts, sequences))

    def take(self, message: Any) -> None:
        """Take the next message of the stream."""
        kind = type(message)
        if kind is self.kind:
            self._sample(message.sequence)
        elif kind is SoftwareVersion:       # sent once, right after power-on
            self._power_on = True
            self._end_without_a_sample()
        elif kind not in (Navigation, InertialTime, NavigationTime):
            return
        elif self._latest is None or self._power_on:
            self._early.append(message)
        elif kind is Navigation:
            self.navigation.pair(message.sequence, self._latest.sequence)
        elif message.valid:
            self._time(message, self._latest)

    def finish(self, start: int | None) -> None:
        """End the stream; start is the ROS time of the first time message, in ns."""
        self._decide()
        before = self.before or CountedSequence(-1, 0)
        self.times.finish(start, min((self.navigation.count(sequence, before) or before.count
                                      for sequence in self._ahead), default=0))

    def _sample(self, sequence: int) -> None:
        before = self._latest
        if before is None:
            before = self.before = CountedSequence(-1, (sequence - 1) % COUNTER_MODULUS)
            self._power_on = False          # it is on since before the first sample
        ahead = (sequence - before.sequence) % COUNTER_MODULUS  # 0: the same frame again
        if self._power_on:
            ahead = COUNTER_MODULUS // 2    # it counts from 0; room for what was lost since
        found = CountedSequence(before.count + ahead, sequence)
        if ahead != 1:
            for column, value in zip(self._jumps, (self._received, found.count, sequence)):
                column.append(value)
            self.times.jump(Jump(self.step * before.count,
                                 self.step * (found.count - bool(self._early)),
                                 sequence, self._power_on))
        self._power_on = False
        self._take_early(CountedSequence(found.count - 1, (sequence - 1) % COUNTER_MODULUS))
        self._latest = found
        self._received += 1

    def _end_without_a_sample(self) -> None:
        """Take what came of a device that was switched off before any sample was received."""
        numbers = [message.sequence for message in self._early if type(message) is Navigation]
        if self._latest is None and self.kind is Inertial and numbers:
            self._power_on = False
            self.before = CountedSequence(-1, PER_NAVIGATION * numbers[-1] % COUNTER_MODULUS)
            self._take_early(self.before)
            self._power_on = True

    def _take_early(self, unheard: CountedSequence) -> None:
        """Take what came before a sample and after the one before that, which was not heard."""
        early = list(self._early)
        self._early.clear()
        self._latest = unheard
        for message in early:
            self.take(message)
            if type(message) is Navigation and unheard.count < 0:
                self._ahead.append(message.sequence)

    def _time(self, message: TimeMessage, latest: CountedSequence) -> None:
        """Take a time message that follows a sample."""
        if (named := self._named(message, latest)) is None:
            return
        if self._undecided is None:
            self._anchor(message, latest, self._received)
            return
        count, step = named
        ahead, rest = divmod(count - latest.count, step)
        if not rest:
            self.convention.vote(ahead)
        self._undecided.append((message, latest, self._received))
        if len(self._undecided) == DECIDING:
            self._decide()

    def _decide(self) -> None:
        """Use the first time messages, now that it is clear which samples they name."""
        undecided, self._undecided = self._undecided or [], None
        for anchor in undecided:
            self._anchor(*anchor)

    def _anchor(self, message: TimeMessage, latest: CountedSequence, received: int) -> None:
        time, named = message.device_time_us * NS_PER_US, self._named(message, latest)
        if named and 0 < time < LONGEST_TIME:
            count, step = named
            sample = self.step * (count - step * self.convention.ahead)
            self.times.anchor(Anchor(sample, time, self.step * received))

    def _named(self, message: TimeMessage, latest: CountedSequence) -> tuple[int, int] | None:
        """Return the sample that a time message names, and how far it is to the next such one."""
        reference, of_navigation = message.reference_sequence, type(message) is NavigationTime
        if of_navigation and self.kind is Inertial:
            count = self.navigation.count(reference, latest)
            return None if count is None else (count, PER_NAVIGATION)
        if of_navigation is (self.kind is Navigation):
            return latest.nearest(reference), 1
        return None
