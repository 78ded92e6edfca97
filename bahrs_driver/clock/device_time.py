# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The device time of samples by their count, and whether it can be trusted.

A time message that fits the timeline moves its anchor. One that does not fit may be wrong, or may
mean that the device was restarted or that counts were lost. It becomes a candidate. Device time is
not known until another message agrees with the candidate or with the timeline.
"""

from bahrs_driver.clock.counter import SampleCounter
from bahrs_driver.clock.navigation import NavigationCounter
from bahrs_driver.clock.time_reference import Label, TimeReferenceConvention
from bahrs_driver.clock.timeline import Timeline
from bahrs_driver.protocol.message_roles import MessageRoles
from bahrs_driver.units import NS_PER_MS, NS_PER_S

EARLIEST, LATEST = -3 * NS_PER_MS, NS_PER_S         # lateness of a sample on the same clock


class DeviceTime:
    """Counts samples, and computes their device times."""

    def __init__(self, roles: MessageRoles, label: Label = 'auto') -> None:
        """Expect the rates of the device, and a convention of its time messages."""
        self._period, self._per_navigation = roles.sample_period, roles.samples_per_navigation
        self.counter = SampleCounter(self._period)
        self.convention = TimeReferenceConvention(label)
        self.navigation = NavigationCounter(self._per_navigation)
        self.known = False
        self.awaits_sample = True       # no count is known until the next sample
        self.rejected = 0               # time messages that contradicted the timeline
        self._timeline: Timeline | None = None
        self._candidate: Timeline | None = None
        self._count_lost = False        # counts do not belong to the timeline any more

    @property
    def period(self) -> float | None:
        """Nanoseconds from one sample to the next, if device time was ever known."""
        return self._timeline.period if self._timeline else None

    @property
    def anchored(self) -> bool:
        """Whether counts belong to the timeline, even if it is doubted at present."""
        return self._timeline is not None and not self._count_lost

    def time_of(self, count: int) -> int:
        """Return the device time of a sample. It must be known."""
        assert self._timeline
        return self._timeline.time_of(count)

    def count_at(self, time: int) -> int:
        """Return the count of the sample nearest to a device time. It must be known."""
        assert self._timeline
        return self._timeline.count_at(time)

    def await_sample(self) -> None:
        """Discard the count after a silence in which the counter may have wrapped."""
        self.awaits_sample = True
        self._lose_count()

    def discard(self) -> None:
        """Discard device time and the count: the device was switched on."""
        self._timeline = None
        self.await_sample()

    def resume_count(self, sequence: int, bound: int) -> None:
        """Continue as if the sample before the one with this counter had just arrived."""
        self.counter.expect(sequence, bound)
        self.awaits_sample = False

    def jump_count(self, sequence: int, bound: int) -> None:
        """Count a sample whose true count is unknown until the next time message."""
        self.counter.jump(sequence, bound)
        self._lose_count()

    def pair(self, sequence: int) -> None:
        """Add the counter of a navigation message that follows the latest sample."""
        self.navigation.pair(sequence, self.counter.latest.sequence)

    def count_for_sample_time(self, reference: int) -> int:
        """Return the count of the sample to which a sample time message gives a time."""
        named = self.counter.latest.nearest(reference)
        self.convention.vote(named - self.counter.count)
        return named - self.convention.ahead

    def count_for_navigation_time(self, reference: int) -> int | None:
        """Return the count of the sample to which a navigation time message gives a time."""
        named = self.navigation.count(reference, self.counter.latest)
        if named is None:
            return None
        ahead, odd = divmod(named - self.counter.count, self._per_navigation)
        if not odd:
            self.convention.vote(ahead)
        return named - self._per_navigation * self.convention.ahead

    def agrees(self, count: int, time: int) -> bool:
        """Whether the device time of a sample fits the timeline."""
        return self._timeline is not None and self._timeline.agrees(count, time)

    def add_time(self, count: int, time: int, lateness: int | None) -> bool:
        """
        Add the device time of a sample; return whether it shows that the clock has jumped.

        If device time is not known afterwards, another message must confirm this one. lateness
        is how much later than estimated the message arrived, if its time is right; None without
        an estimate.
        """
        timeline, candidate = self._timeline, self._candidate
        # Device time decreases only if the clock was set.
        same_clock = timeline is not None and time > timeline.latest[1] and (
            lateness is not None and EARLIEST <= lateness <= LATEST)
        if timeline and timeline.agrees(count, time):      # even if the counter may have wrapped
            timeline.accept(count, time)
        elif timeline and self._count_lost and same_clock:
            timeline.move(count, time)
        elif candidate and self._confirms(candidate, count, time):
            candidate.accept(count, time)
            self._timeline = candidate
        else:
            self._doubt(count, time)
            return False
        self._trust()
        return self._timeline is not timeline and not same_clock

    def stop_doubting(self) -> bool:
        """
        Trust the timeline if counts belong to it, else the candidate if there is one.

        Return whether the candidate was trusted, so that the clock has jumped.
        """
        if self.known or self.anchored:
            self._trust()
            return False
        if self._candidate:
            self._timeline = self._candidate
            self._trust()
            return True
        return False

    def _confirms(self, candidate: Timeline, count: int, time: int) -> bool:
        """Whether a time message agrees with the candidate and is not merely a repetition."""
        repeated = self.anchored and time == candidate.latest[1]
        return candidate.agrees(count, time) and not repeated

    def _trust(self) -> None:
        self._candidate = None
        self._count_lost, self.known = False, True

    def _doubt(self, count: int, time: int) -> None:
        self.rejected += self.anchored
        self._candidate = Timeline(count, time, self._period)
        self.known = False

    def _lose_count(self) -> None:
        # The count of an earlier candidate is lost as well.
        self._candidate = None
        self._count_lost, self.known = True, False
