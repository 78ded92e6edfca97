# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The samples of a stream whose reads have no host time, counted by their counters.

Samples are the messages of one type: by default the device's samples, or the navigation messages
of a stream that has no others. Both are counted in sample periods. Messages before the first
sample, or after power-on, belong to the sample before the next one: it was sent, but not received.
"""

from collections import deque
from typing import Any

from bahrs_driver.clock.counter import CountedSequence
from bahrs_driver.clock.navigation import NavigationCounter
from bahrs_driver.clock.time_reference import Label, TimeReferenceConvention, VOTES
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.reprocess.sample_times import Anchor, Jump, SampleTimes
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_US

DECIDING = 99                       # time messages that decide on the convention
MOST_EARLY = 1000                   # messages before a sample
LONGEST_TIME = 2 ** 62              # ns; a later time is an error


class CountedStream:
    """Examines the messages of a stream, and finds the time of each sample."""

    def __init__(self, roles: MessageRoles, kind: type[Any], label: Label = 'auto',
                 votes: int = DECIDING) -> None:
        """
        Count messages of the type `kind`.

        label is the convention of time messages. The first time messages, as many as `votes`, are
        used once they have decided on it; with 0 votes, each one at once.
        """
        self.kind = kind
        # Sample periods from one message to the next.
        self.step = roles.samples_per_navigation if kind is roles.navigation else 1
        self.times = SampleTimes(roles.sample_period)
        self.convention = TimeReferenceConvention(label, votes or VOTES)
        self.navigation = NavigationCounter(roles.samples_per_navigation)
        self.before: CountedSequence | None = None      # the sample before the first one
        self._roles, self._votes = roles, votes
        self._time_messages = (roles.sample_time, roles.navigation_time)
        self._latest: CountedSequence | None = None
        self._received = 0
        self._ahead: list[int] = []     # navigation messages before the first sample
        self._early: deque[Any] = deque(maxlen=MOST_EARLY)
        self._power_on = False
        # Time messages before the convention is decided.
        self._undecided: list[tuple[Any, CountedSequence, int]] | None = [] if votes else None

    @property
    def count(self) -> int:
        """Count of the latest sample; the first one has 0."""
        return self.step * (self._latest.count if self._latest else -1)

    def take(self, message: Any) -> None:
        """Examine the next message of the stream."""
        kind, roles = type(message), self._roles
        if kind is self.kind:
            self._take_sample(message.sequence)
        elif kind is roles.power_on:
            self._power_on = True
            self._end_without_a_sample()
        elif kind is not roles.navigation and kind not in self._time_messages:
            return
        elif self._latest is None or self._power_on:
            self._early.append(message)
        elif kind is roles.navigation:
            self.navigation.pair(message.sequence, self._latest.sequence)
        elif message.valid:
            self._take_time(message, self._latest)

    def finish(self, start: int | None) -> None:
        """End the stream; start is the ROS time of the first time message, in ns."""
        self._decide()
        before = self.before or CountedSequence(-1, 0)
        self.times.finish(start, min((self.navigation.count(sequence, before) or before.count
                                      for sequence in self._ahead), default=0))

    def _take_sample(self, sequence: int) -> None:
        before = self._latest
        if before is None:
            before = self.before = CountedSequence(-1, (sequence - 1) % COUNTER_MODULUS)
            self._power_on = False          # it happened before the first sample
        ahead = (sequence - before.sequence) % COUNTER_MODULUS  # 0: the same frame again
        if self._power_on:
            ahead = COUNTER_MODULUS // 2    # the counter is at 0; leave room for lost samples
        found = CountedSequence(before.count + ahead, sequence)
        if ahead != 1:
            self.times.jump(Jump(self.step * before.count,
                                 self.step * (found.count - bool(self._early)),
                                 sequence, self._power_on))
        self._power_on = False
        self._take_early(CountedSequence(found.count - 1, (sequence - 1) % COUNTER_MODULUS))
        self._latest = found
        self._received += 1

    def _end_without_a_sample(self) -> None:
        """Examine the messages of a device that was switched off before a sample arrived."""
        roles = self._roles
        numbers = [item.sequence for item in self._early if type(item) is roles.navigation]
        if self._latest is None and self.kind is roles.sample and numbers:
            self._power_on = False
            self.before = CountedSequence(
                -1, roles.samples_per_navigation * numbers[-1] % COUNTER_MODULUS)
            self._take_early(self.before)
            self._power_on = True

    def _take_early(self, unreceived: CountedSequence) -> None:
        """Examine the messages between two samples, the second of which was not received."""
        early = list(self._early)
        self._early.clear()
        self._latest = unreceived
        for message in early:
            self.take(message)
            if type(message) is self._roles.navigation and unreceived.count < 0:
                self._ahead.append(message.sequence)

    def _take_time(self, message: Any, latest: CountedSequence) -> None:
        """Examine a time message behind a sample."""
        if (named := self._named(message, latest)) is None:
            return
        if self._undecided is not None or not self._votes:
            count, step = named
            ahead, rest = divmod(count - latest.count, step)
            if not rest:
                self.convention.vote(ahead)
        if self._undecided is None:
            self._anchor(message, latest, self._received)
            return
        self._undecided.append((message, latest, self._received))
        if len(self._undecided) == self._votes:
            self._decide()

    def _decide(self) -> None:
        """Use the first time messages, as their convention is known now."""
        undecided, self._undecided = self._undecided or [], None
        for anchor in undecided:
            self._anchor(*anchor)

    def _anchor(self, message: Any, latest: CountedSequence, received: int) -> None:
        time, named = message.device_time_us * NS_PER_US, self._named(message, latest)
        if named and 0 < time < LONGEST_TIME:
            count, step = named
            sample = self.step * (count - step * self.convention.ahead)
            self.times.anchor(Anchor(sample, time, self.step * received))

    def _named(self, message: Any, latest: CountedSequence) -> tuple[int, int] | None:
        """Return the sample that a time message names, and the step to the next such one."""
        roles, reference = self._roles, message.reference_sequence
        of_navigation = type(message) is roles.navigation_time
        if of_navigation and self.kind is roles.sample:
            count = self.navigation.count(reference, latest)
            return None if count is None else (count, roles.samples_per_navigation)
        if of_navigation is (self.kind is roles.navigation):
            return latest.nearest(reference), 1
        return None
