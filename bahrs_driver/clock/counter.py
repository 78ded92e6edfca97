# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which sample a frame is: its uint8 counter, counted on.

A frame may be lost, so the counter may be ahead by any number; but not by more than time has
passed. A counter that is not so was damaged, or its frame came twice, and says nothing. If the
frame after it follows on the one before it, all is well again. Too many such in a row, or
a silence that may have been a turn of the counter, mean that only a time message can tell.
"""

from dataclasses import dataclass

from bahrs_driver.units import COUNTER_MODULUS, NS_PER_MS, NS_PER_S

PERIOD = 5 * NS_PER_MS          # nominal, from one inertial sample to the next
LONGEST_SILENCE = 4 * NS_PER_S // 10        # less than a device takes to start
FAR = 20                        # samples; if more are missing, so is a time message
SLACK = NS_PER_S // 10          # what a bound may be late by
DOUBTS = 3                      # counters in a row that make no sense


@dataclass(frozen=True, slots=True)
class CountedSequence:
    """A sample's count, and the counter that its frame has or should have had."""

    count: int
    sequence: int

    def nearest(self, sequence: int) -> int:
        """Return the count of the sample with a counter that is nearest to this one."""
        half = COUNTER_MODULUS // 2
        return self.count + (sequence - self.sequence + half) % COUNTER_MODULUS - half


class SampleCounter:
    """Counts samples on from their counters."""

    def __init__(self) -> None:
        self.rejected = 0
        self.count = 0                  # of the latest sample
        self._sequence = -1             # of the latest counter that made sense
        self._trusted = 0               # its count
        self._before = -1, 0            # counter and count of the one before that
        self._bound = 0                 # of the latest frame
        self._trusted_bound = 0
        self._doubts = 0

    @property
    def started(self) -> bool:
        """Whether there was a sample."""
        return self._sequence >= 0

    @property
    def latest(self) -> CountedSequence:
        """Count of the latest sample, and its counter or what it should have been."""
        sequence = (self._sequence + self.count - self._trusted) % COUNTER_MODULUS
        return CountedSequence(self.count, sequence)

    def silence_before(self, bound: int) -> bool:
        """Whether a frame with this bound comes after so long a time that turns may be lost."""
        return self.started and bound - self._bound > LONGEST_SILENCE

    def may_have_turned(self, sequence: int, latest: int | None) -> bool:
        """Whether the highest count that a frame can have leaves room for a turn that was lost."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        return latest is not None and self._trusted + ahead + COUNTER_MODULUS <= latest

    def far(self, sequence: int, bound: int, latest: int | None) -> bool:
        """Whether so many samples are missing that it may be another counter that goes on."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        return self.started and ahead > FAR and self._trusted + ahead <= self._limit(bound, latest)

    def follow(self, sequence: int, bound: int) -> bool:
        """Take the next frame if it follows on the latest, as nearly all do; return whether."""
        if not self.started or self._doubts or (
                sequence != (self._sequence + 1) % COUNTER_MODULUS):
            return False
        self._before = self._sequence, self._trusted
        self._sequence = sequence
        self._trusted += 1
        self.count = self._trusted
        self._bound = self._trusted_bound = bound
        return True

    def place(self, sequence: int, bound: int, latest: int | None) -> bool:
        """
        Take the next frame; count is then its place. Return whether its counter made sense.

        bound is the host's time that it was not sent after, latest the highest count that it can
        have by what is known of the device's time.
        """
        latest = self._limit(bound, latest)
        self._bound = bound
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        if not self.started:
            self._trust(sequence, 0, bound)
        elif ahead and self._trusted + ahead <= latest:
            self._trust(sequence, self._trusted + ahead, bound)
        elif not self._retrust(sequence, bound):
            self.rejected += 1
            self._doubts += 1
            self.count += bool(ahead)       # the same counter again: the same sample
            return False
        return True

    def jump(self, sequence: int, bound: int) -> None:
        """Take a frame whose count does not follow from the one before."""
        self.expect(sequence, bound)
        self.follow(sequence, bound)

    def expect(self, sequence: int, bound: int) -> None:
        """Go on as if the frame before that with this counter had come."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS or COUNTER_MODULUS
        self._trust((sequence - 1) % COUNTER_MODULUS, self._trusted + ahead - 1, bound)
        self._before = -1, 0
        self._bound = bound

    @property
    def lost(self) -> bool:
        """Whether the counter has made no sense for too long."""
        return self._doubts >= DOUBTS

    def _limit(self, bound: int, latest: int | None) -> int:
        """Return the highest count that a frame can have; latest is that if it is known."""
        if latest is not None:
            return latest
        return self._trusted + (bound - self._trusted_bound + SLACK) // PERIOD + 1

    def _trust(self, sequence: int, count: int, bound: int) -> None:
        self._before = self._sequence, self._trusted
        self._sequence, self._trusted = sequence, count
        self.count = count
        self._trusted_bound = bound
        self._doubts = 0

    def _retrust(self, sequence: int, bound: int) -> bool:
        """See whether the latest counter was the damaged one, for this follows the one before."""
        before, count = self._before
        if before < 0 or self._doubts or (sequence - before) % COUNTER_MODULUS != 2:
            return False
        self.rejected += 1
        self._trust(sequence, count + 2, bound)
        self._before = -1, 0
        return True
