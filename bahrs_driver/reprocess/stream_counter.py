# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Count the samples of a stream whose reads have no host time, by their sequence counters.

Samples are the messages of one type: by default the device's samples, or the navigation messages
of a stream that has no others. Both are counted in sample periods. Messages before the first
sample, or after power-on, belong to the sample before the next one: it was sent, but not received.

A time message between two consecutive samples shows the convention of time messages. Beside a lost
sample it shows nothing: each convention looks like the other one with a sample lost.
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
MOST_PENDING = 1000                 # messages before a sample
LONGEST_TIME = 2 ** 62              # ns; a later time is an error


class StreamCounter:
    """Counts the samples of a stream, and finds the time of each."""

    def __init__(self, roles: MessageRoles, kind: type[Any], label: Label = 'auto',
                 votes: int = DECIDING) -> None:
        """
        Count messages of the type `kind`.

        label is the convention of time messages. The first time messages, as many as `votes`, are
        used once they have decided on it; with 0 votes, as soon as one of them has shown it.
        """
        self.kind = kind
        # Sample periods from one message to the next.
        self.step = roles.samples_per_navigation if kind is roles.navigation else 1
        self.times = SampleTimes(roles.sample_period)
        self.convention = TimeReferenceConvention(label, votes or VOTES)
        self.navigation = NavigationCounter(roles.samples_per_navigation)
        self.origin: CountedSequence | None = None      # the sample before the first one
        self._roles = roles
        self._time_messages = (roles.sample_time, roles.navigation_time)
        self._latest: CountedSequence | None = None
        self._received = 0                              # samples
        # Messages before the next sample, with their types:
        self._pending: deque[tuple[type[Any], Any]] = deque(maxlen=MOST_PENDING)
        self._early_navigation: list[int] = []          # counters of those before the first one
        self._power_on = False                          # since the latest sample
        self._votes = votes
        self._convention_decided = False
        self._unconfirmed: list[int] = []               # votes since the latest sample
        # Arguments of _add_anchor:
        self._undecided: deque[tuple[type[Any], Any, CountedSequence, int]] = deque(
            maxlen=MOST_PENDING)

    @property
    def count(self) -> int:
        """Count of the latest sample; the first one has 0."""
        return self.step * (self._latest.count if self._latest else -1)

    def observe(self, kind: type[Any], message: Any) -> None:
        """Examine the next message of the stream; it may have only the fields that count it."""
        roles = self._roles
        if kind is self.kind:
            self._observe_sample(message.sequence)
        elif kind is roles.power_on:
            self._power_on = True
            self._end_without_sample()
        elif kind is not roles.navigation and kind not in self._time_messages:
            return
        elif self._latest is None or self._power_on:
            self._pending.append((kind, message))
        elif kind is roles.navigation:
            self.navigation.pair(message.sequence, self._latest.sequence)
        elif message.valid:
            self._observe_time(kind, message, self._latest)

    def discard_times(self) -> None:
        """Discard all time messages: the samples so far get no certain time any more."""
        self._undecided.clear()
        self.times.discard_anchors(self.count)

    def assign_ros_times(self, start: int | None) -> None:
        """End the stream; start is the ROS time of the first time message, in ns."""
        self._use_undecided()
        origin = self.origin or CountedSequence(-1, 0)
        self.times.assign_ros_times(start, min(
            (self.navigation.count(sequence, origin) or origin.count
             for sequence in self._early_navigation), default=0))

    def _observe_sample(self, sequence: int) -> None:
        previous = (sequence - 1) % COUNTER_MODULUS
        before = self._latest
        if before is None:
            before = self.origin = CountedSequence(-1, previous)
            self._power_on = False          # it happened before the first sample
        ahead = (sequence - before.sequence) % COUNTER_MODULUS  # 0: the same frame again
        if self._power_on:
            ahead = COUNTER_MODULUS // 2    # the counter is at 0; leave room for lost samples
        sample = CountedSequence(before.count + ahead, sequence)
        if ahead != 1:
            self.times.add_jump(Jump(self.step * before.count,
                                     self.step * (sample.count - bool(self._pending)),
                                     sequence, self._power_on))
        self._power_on = False
        if self._unconfirmed:
            self._confirm_votes(consecutive=ahead == 1)
        if self._pending:
            self._observe_pending(CountedSequence(sample.count - 1, previous))
        self._latest = sample
        self._received += 1

    def _end_without_sample(self) -> None:
        """Examine the messages of a device that was switched off before a sample arrived."""
        roles = self._roles
        numbers = [item.sequence for kind, item in self._pending if kind is roles.navigation]
        if self._latest is None and self.kind is roles.sample and numbers:
            self._power_on = False
            self.origin = CountedSequence(
                -1, roles.samples_per_navigation * numbers[-1] % COUNTER_MODULUS)
            self._observe_pending(self.origin)
            self._power_on = True

    def _observe_pending(self, unreceived: CountedSequence) -> None:
        """Examine the messages that follow a sample which was not received."""
        messages = list(self._pending)
        self._pending.clear()
        self._latest = unreceived
        for kind, message in messages:
            self.observe(kind, message)
            if kind is self._roles.navigation and unreceived.count < 0:
                self._early_navigation.append(message.sequence)
        self._unconfirmed.clear()

    def _confirm_votes(self, consecutive: bool) -> None:
        """Count the votes since the latest sample if the next one is consecutive."""
        if consecutive:
            for ahead in self._unconfirmed:
                self.convention.vote(ahead)
            if not self._votes and self.convention.seen:
                self._use_undecided()
        self._unconfirmed.clear()

    def _observe_time(self, kind: type[Any], message: Any, latest: CountedSequence) -> None:
        """Examine a time message that follows a sample."""
        reference = self._reference(kind, message, latest)
        if reference is None:
            return
        if not self._convention_decided:
            count, step = reference
            ahead, rest = divmod(count - latest.count, step)
            if not rest:
                self._unconfirmed.append(ahead)
        self._undecided.append((kind, message, latest, self._received))
        if len(self._undecided) == self._votes:
            self._convention_decided = True
        if self._convention_decided or not self._votes and self.convention.seen:
            self._use_undecided()

    def _use_undecided(self) -> None:
        """Use the time messages that waited for their convention."""
        for arguments in self._undecided:
            self._add_anchor(*arguments)
        self._undecided.clear()

    def _add_anchor(self, kind: type[Any], message: Any, latest: CountedSequence,
                    received: int) -> None:
        time = message.device_time_us * NS_PER_US
        reference = self._reference(kind, message, latest)
        if reference and 0 < time < LONGEST_TIME:
            count, step = reference
            sample = self.step * (count - step * self.convention.ahead)
            self.times.add_anchor(Anchor(sample, time, self.step * received))

    def _reference(self, kind: type[Any], message: Any,
                   latest: CountedSequence) -> tuple[int, int] | None:
        """Return the sample that a time message names, and the step to the next such one."""
        roles, sequence = self._roles, message.reference_sequence
        of_navigation = kind is roles.navigation_time
        if of_navigation and self.kind is roles.sample:
            count = self.navigation.count(sequence, latest)
            return None if count is None else (count, roles.samples_per_navigation)
        if of_navigation is (self.kind is roles.navigation):
            return latest.nearest(sequence), 1
        return None
