# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The count of each sample, from its uint8 sequence counter.

Frames may be lost, so a counter may be ahead by any number, but not by more than the elapsed time
allows. A counter that is ahead by more was corrupted, or its frame came twice, and is ignored. If
the frame behind it continues the one before it, counting goes on. After too many implausible
counters in a row, or after a silence in which the counter may have wrapped, only a time message
can give the count.
"""

from dataclasses import dataclass

from bahrs_driver.units import COUNTER_MODULUS, NS_PER_S

LONGEST_SILENCE = 4 * NS_PER_S // 10        # less than a device takes to start
FAR = 20                        # samples; a longer gap contains a time message
SLACK = NS_PER_S // 10          # by which a bound may be late
MAX_DOUBTS = 3                  # implausible counters in a row


@dataclass(frozen=True, slots=True)
class CountedSequence:
    """The count of a sample, and its sequence counter (or the one that it should have)."""

    count: int
    sequence: int

    def nearest(self, sequence: int) -> int:
        """Return the count nearest to this one of a sample with a given counter."""
        half = COUNTER_MODULUS // 2
        return self.count + (sequence - self.sequence + half) % COUNTER_MODULUS - half


class SampleCounter:
    """Counts samples by their sequence counters."""

    def __init__(self, period: int) -> None:
        """Count samples of a nominal period in ns."""
        self.rejected = 0
        self._period = period
        self.count = 0                  # of the latest sample
        self._sequence = -1             # latest plausible counter
        self._trusted = 0               # its count
        self._before = -1, 0            # counter and count of the plausible one before that
        self._bound = 0                 # of the latest frame
        self._trusted_bound = 0
        self._doubts = 0

    @property
    def started(self) -> bool:
        """Whether there was a sample."""
        return self._sequence >= 0

    @property
    def latest(self) -> CountedSequence:
        """Count of the latest sample, and the counter that it has or should have."""
        sequence = (self._sequence + self.count - self._trusted) % COUNTER_MODULUS
        return CountedSequence(self.count, sequence)

    @property
    def lost(self) -> bool:
        """Whether too many counters in a row were implausible."""
        return self._doubts >= MAX_DOUBTS

    def silence_before(self, bound: int) -> bool:
        """Whether the counter may have wrapped in the silence before a frame with this bound."""
        return bound - self._bound > LONGEST_SILENCE and self.started

    def may_have_wrapped(self, sequence: int, highest: int | None) -> bool:
        """Whether the counter may have wrapped, as far as the highest possible count allows."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        return highest is not None and self._trusted + ahead + COUNTER_MODULUS <= highest

    def is_far(self, sequence: int, bound: int, highest: int | None) -> bool:
        """Whether so many samples are missing that the device may have been restarted."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        return self.started and ahead > FAR and (
            self._trusted + ahead <= self._limit(bound, highest))

    def advance(self, sequence: int, bound: int) -> bool:
        """Count the next frame if its counter follows the latest one; return whether it does."""
        if self._doubts or self._sequence < 0 or (
                sequence != (self._sequence + 1) % COUNTER_MODULUS):
            return False
        self._before = self._sequence, self._trusted
        self._sequence = sequence
        self._trusted += 1
        self.count = self._trusted
        self._bound = self._trusted_bound = bound
        return True

    def add(self, sequence: int, bound: int, highest: int | None) -> bool:
        """
        Count the next frame; return whether its counter is plausible.

        bound is the latest host time at which the frame was sent, highest the highest count that
        it can have by device time, if that is known.
        """
        limit = self._limit(bound, highest)
        self._bound = bound
        ahead = (sequence - self._sequence) % COUNTER_MODULUS
        if not self.started:
            self._trust(sequence, 0, bound)
        elif ahead and self._trusted + ahead <= limit:
            self._trust(sequence, self._trusted + ahead, bound)
        elif not self._skip_corrupted(sequence, bound):
            self.rejected += 1
            self._doubts += 1
            self.count += bool(ahead)       # a repeated counter is no new sample
            return False
        return True

    def jump(self, sequence: int, bound: int) -> None:
        """Count a frame whose count does not follow from the one before."""
        self.expect(sequence, bound)
        self.advance(sequence, bound)

    def expect(self, sequence: int, bound: int) -> None:
        """Continue as if the sample before the one with this counter had just arrived."""
        ahead = (sequence - self._sequence) % COUNTER_MODULUS or COUNTER_MODULUS
        self._trust((sequence - 1) % COUNTER_MODULUS, self._trusted + ahead - 1, bound)
        self._before = -1, 0
        self._bound = bound

    def _limit(self, bound: int, highest: int | None) -> int:
        """Return the highest count by device time if that is known, else by elapsed time."""
        if highest is not None:
            return highest
        return self._trusted + (bound - self._trusted_bound + SLACK) // self._period + 1

    def _trust(self, sequence: int, count: int, bound: int) -> None:
        self._before = self._sequence, self._trusted
        self._sequence, self._trusted = sequence, count
        self.count = count
        self._trusted_bound = bound
        self._doubts = 0

    def _skip_corrupted(self, sequence: int, bound: int) -> bool:
        """Discard the latest counter if the new one follows the one before it."""
        before, count = self._before
        if before < 0 or self._doubts or (sequence - before) % COUNTER_MODULUS != 2:
            return False
        self.rejected += 1
        self._trust(sequence, count + 2, bound)
        self._before = -1, 0
        return True
