# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Sequence numbers to device time, and whether they can be believed.

A time message that fits what is known moves the anchor. One that does not may be wrong, or may
tell that the device was restarted or that counts were lost: it is remembered, and nothing is
known until a second one has agreed with it or another with what was known before.
"""

from enum import Enum

from bahrs_driver.clock.counter import SampleCounter
from bahrs_driver.clock.labels import Label, LabelReading
from bahrs_driver.clock.navigation import NavigationCounter, PER_NAVIGATION
from bahrs_driver.clock.timeline import Timeline
from bahrs_driver.units import NS_PER_MS, NS_PER_S

EARLIEST, LATEST = -3 * NS_PER_MS, NS_PER_S         # lateness of a sample of the same clock


class Verdict(Enum):
    """What a time message means."""

    KNOWN = 'device time is known, on the same clock'
    NEW_EPOCH = 'device time is known, and its clock has jumped'
    DOUBTED = 'another one must agree with it'


class DeviceTime:
    """Gives samples their count, and counts their device time."""

    def __init__(self, label: Label = 'auto') -> None:
        self.counter = SampleCounter()
        self.labels = LabelReading(label)
        self.known = False
        self.adrift = True              # no count is known until the next sample
        self.rejected = 0               # time messages that contradicted
        self.navigation = NavigationCounter()
        self._timeline: Timeline | None = None
        self._candidate: Timeline | None = None
        self._lost = False

    @property
    def period(self) -> float | None:
        """Nanoseconds from one sample to the next, if device time was ever known."""
        return self._timeline.period if self._timeline else None

    @property
    def anchored(self) -> bool:
        """Whether counts go with a device time that was known, though it may be doubted now."""
        return self._timeline is not None and not self._lost

    def time_of(self, count: int) -> int:
        """Return the device time of a sample. It must be known."""
        assert self._timeline
        return self._timeline.time_of(count)

    def count_at(self, time: int) -> int:
        """Return the count of the sample that is nearest to a device time."""
        assert self._timeline
        return self._timeline.count_at(time)

    def cut_adrift(self) -> None:
        """Forget the present count after a silence, in which the counter may have turned."""
        self.adrift = True
        self._lose()

    def forget(self) -> None:
        """Forget also device time: the device was switched on, and its clock begins again."""
        self._timeline = None
        self.cut_adrift()

    def find(self, sequence: int, bound: int) -> None:
        """End being adrift: go on as if the sample before that with this counter had come."""
        self.counter.expect(sequence, bound)
        self.adrift = False

    def lose(self, sequence: int, bound: int) -> None:
        """Take a sample whose count can only be told by the next time message."""
        self.counter.jump(sequence, bound)
        self._lose()

    def pair(self, sequence: int) -> None:
        """Take the counter of a navigation message that follows the latest inertial one."""
        self.navigation.pair(sequence, self.counter.latest.sequence)

    def inertial_time(self, reference: int) -> int:
        """Return the count of the sample that an inertial time message is about."""
        named = self.counter.latest.nearest(reference)
        self.labels.vote(named - self.counter.count)
        return named - self.labels.ahead

    def navigation_time(self, reference: int) -> int | None:
        """Return the count of the sample that a navigation time message is about."""
        named = self.navigation.count(reference, self.counter.latest)
        if named is None:
            return None
        ahead, odd = divmod(named - self.counter.count, PER_NAVIGATION)
        if not odd:
            self.labels.vote(ahead)
        return named - PER_NAVIGATION * self.labels.ahead

    def agrees(self, count: int, time: int) -> bool:
        """Whether a sample's device time fits what is known."""
        return self._timeline is not None and self._timeline.agrees(count, time)

    def time_message(self, count: int, time: int, lateness: int | None) -> Verdict:
        """
        Take the device time of a sample, and say what it means.

        lateness is how much later than the believed clock has it the latest sample came, if that
        message is right; None if no clock is believed yet.
        """
        timeline, candidate = self._timeline, self._candidate
        # Device time goes back only when it is set again, by however little.
        fits = timeline is not None and time > timeline.latest[1] and (
            lateness is not None and EARLIEST <= lateness <= LATEST)
        if timeline and timeline.agrees(count, time):      # also if turns might have been lost
            timeline.accept(count, time)
        elif timeline and self._lost and fits:
            timeline.move(count, time)
        elif candidate and candidate.agrees(count, time) and not self._repeats(candidate, time):
            candidate.accept(count, time)
            return self._adopt(candidate, fits)
        else:
            return self._doubt(count, time)
        return self._know()

    def stop_doubting(self) -> Verdict:
        """Go by what there is: what was known if it is doubted, or else what doubts it."""
        if self.known or (self._timeline and not self._lost):
            return self._know()
        if self._candidate:
            return self._adopt(self._candidate, False)
        return Verdict.DOUBTED

    def _repeats(self, candidate: Timeline, time: int) -> bool:
        """Whether this would be the second word of one instant against a clock that is known."""
        return self._timeline is not None and not self._lost and time == candidate.latest[1]

    def _adopt(self, candidate: Timeline, same_clock: bool) -> Verdict:
        self._timeline = candidate
        self._know()
        return Verdict.KNOWN if same_clock else Verdict.NEW_EPOCH

    def _know(self) -> Verdict:
        self._candidate = None
        self._lost, self.known = False, True
        return Verdict.KNOWN

    def _doubt(self, count: int, time: int) -> Verdict:
        if self._timeline and not self._lost:
            self.rejected += 1
        self._candidate = Timeline(count, time)
        self.known = False
        return Verdict.DOUBTED

    def _lose(self) -> None:
        # A doubt of before speaks of counts that mean nothing any more.
        self._candidate = None
        self._lost, self.known = True, False
