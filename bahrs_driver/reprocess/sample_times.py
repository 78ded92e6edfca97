# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time of every sample in a stream of bytes that was kept without times.

Each time message anchors the count of a sample to a device time, and between two anchors time is
straight. Before the first and after the last one it goes on at the device's period, so a stream
may be cut anywhere. A stream without any time message has the nominal period.

Two anchors may contradict each other. The device was restarted (less time passed than the samples
in between take), it paused or so much was lost that the counter turned (more time passed), or a
time message was wrong. As for the live clock, a single anchor is not believed against others. The
change lies where the counter jumps, or else right before the sample of the second anchor.
"""

from bisect import bisect_right
from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

from bahrs_driver.clock.counter import PERIOD
from bahrs_driver.clock.timeline import PERIOD_TOLERANCE, Timeline
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_S, ROS_TIME_END_S

AFTER_RESTART = NS_PER_S            # ns that a restart is taken to last
LONGEST_PAUSE = 30 * 86_400 * NS_PER_S      # ns; a clock that is further ahead was set
LATEST_TIME = ROS_TIME_END_S * NS_PER_S
MOST_JUMPS = 1000                   # since the latest anchor
_FIRST = -2 ** 62                   # count before all others


class Anchor(NamedTuple):
    """A sample whose device time a message gives."""

    sample: int             # its count
    time: int               # device time in ns
    received: int           # samples received before its time was known


class Jump(NamedTuple):
    """Where counters do not go on by one, or the device says that it was switched on."""

    before: int             # count of the sample before
    after: int              # count of the first sample after that
    sequence: int           # its counter
    power_on: bool

    @property
    def middle(self) -> int:
        """Count that is far from either, for samples were lost on both sides."""
        return (self.before + self.after) // 2


class Stretch(NamedTuple):
    """Samples whose time is straight. It ends where the next stretch begins."""

    begin: int              # count of its first sample
    sample: int             # count of a sample whose time is known
    time: int               # device time of that sample, in ns
    elapsed: int            # ns that so many samples take
    samples: int
    offset: int = 0         # ROS time less device time, in ns

    def time_of(self, count: int) -> int:
        """Return the device time of a sample."""
        return self.time + (count - self.sample) * self.elapsed // self.samples


class SampleTimes:
    """Finds the device time of samples from that of some of them."""

    def __init__(self) -> None:
        self.epochs = 0
        self.rejected = 0                   # anchors that contradicted
        # Since the latest anchor that was believed.
        self._jumps: deque[Jump] = deque(maxlen=MOST_JUMPS)
        self._line: Timeline | None = None
        self._candidate: Timeline | None = None
        self._latest = self._doubted = Anchor(_FIRST, 0, 0)     # of the line, of the candidate
        self._stretches: list[Stretch] = []
        self._begins: list[int] = []

    def jump(self, jump: Jump) -> None:
        """Take a place at which the course of time may change."""
        self._jumps.append(jump)

    def anchor(self, anchor: Anchor) -> None:
        """Take the device time of a sample, in the order of the stream."""
        sample, time, _ = anchor
        line, candidate = self._line, self._candidate
        if line and line.agrees(sample, time):
            self._extend(line, anchor)
            self._candidate = None
        elif candidate and candidate.agrees(sample, time) and time != self._doubted.time:
            self._believe(candidate)
            self._extend(candidate, anchor)
        elif not (candidate and self._doubted[:2] == (sample, time)):
            self.rejected += line is not None
            if candidate and not line and (
                    time > candidate.time_of(sample) or _crossing(
                        self._jumps, self._doubted, anchor)):
                self._believe(candidate)
            self._candidate, self._doubted = Timeline(sample, time), anchor

    def finish(self, start: int | None, first: int) -> None:
        """
        End the stream. first is the count of the first sample.

        start is the ROS time of the first anchor, in ns; without it ROS time is device time.
        """
        if self._candidate and (
                self._line is None or _crossing(self._jumps, self._latest, self._doubted)):
            self._believe(self._candidate)
        if self._line:
            self._extend_to_the_end(self._line)
        else:
            self._add(Stretch(_FIRST, 0, 0, PERIOD, 1))
        head = self._stretches[0]
        shift = 0 if start is None else start - head.time
        if start is None and max(
                stretch.time + stretch.offset for stretch in self._stretches) >= LATEST_TIME:
            shift = -head.time
        shift = max(shift, -head.time_of(first))
        self._stretches = [item._replace(offset=item.offset + shift) for item in self._stretches]

    def stretch(self, count: int) -> Stretch:
        """Return the stretch that a sample is in, once all was taken."""
        return self._stretches[max(0, bisect_right(self._begins, count) - 1)]

    def ros_time(self, count: int) -> int:
        """Return the ROS time of a sample, in ns."""
        stretch = self.stretch(count)
        return stretch.time_of(count) + stretch.offset

    def _extend(self, line: Timeline, anchor: Anchor) -> None:
        """Go straight on to an anchor that agrees."""
        before, self._latest = self._latest, anchor
        samples, elapsed = anchor.sample - before.sample, anchor.time - before.time
        if samples <= 0:
            self._latest = before
            return
        line.accept(anchor.sample, anchor.time)
        last = self._stretches[-1]
        if (last.sample, last.time) == before[:2]:
            self._stretches[-1] = last._replace(elapsed=elapsed, samples=samples)
        elif last.time_of(anchor.sample) != anchor.time:
            self._add(last._replace(begin=before.sample, sample=before.sample, time=before.time,
                                    elapsed=elapsed, samples=samples))
        while self._jumps and self._jumps[0].after <= anchor.sample:
            self._jumps.popleft()

    def _extend_to_the_end(self, line: Timeline) -> None:
        """Go on from the latest anchor at the device's period."""
        sample, time, _ = self._latest
        last, later = self._stretches[-1], sample + COUNTER_MODULUS
        if last.time_of(later) != line.time_of(later):
            self._add(last._replace(begin=sample, sample=sample, time=time,
                                    elapsed=line.time_of(later) - time, samples=COUNTER_MODULUS))

    def _believe(self, candidate: Timeline) -> None:
        """Go on by another anchor than those that were believed so far."""
        anchor = self._doubted
        if self._line is None:
            self._add(Stretch(_FIRST, anchor.sample, anchor.time, PERIOD, 1))
            self.epochs = 1
        else:
            self._cross(self._line, anchor)
        self._line, self._latest, self._candidate = candidate, anchor, None
        while self._jumps and self._jumps[0].before < anchor.sample:
            self._jumps.popleft()

    def _cross(self, line: Timeline, anchor: Anchor) -> None:
        """Find where time jumps between the latest anchor and another one."""
        self._extend_to_the_end(line)
        last, latest = self._stretches[-1], self._latest
        jump = _crossing(self._jumps, latest, anchor) or Jump(
            anchor.sample - 1, anchor.sample, 0, False)
        ended = last.time_of(jump.before)
        begins = anchor.time - (anchor.sample - jump.after) * PERIOD
        new = Stretch(jump.middle if jump.power_on else jump.after, anchor.sample, anchor.time,
                      PERIOD, 1, last.offset)
        if _restarted(latest, anchor) or begins - ended > LONGEST_PAUSE:
            self.epochs += 1
            self._add(new._replace(offset=last.offset + ended + AFTER_RESTART - begins))
        elif begins > ended:
            self._add(new)
        else:                   # counters that cannot be: less time has passed than they say
            self._add(last._replace(begin=latest.sample, sample=latest.sample, time=latest.time,
                                    elapsed=anchor.time - latest.time,
                                    samples=max(1, anchor.sample - latest.sample)))

    def _add(self, stretch: Stretch) -> None:
        self._stretches.append(stretch)
        self._begins.append(stretch.begin)


def _restarted(before: Anchor, after: Anchor) -> bool:
    """Return whether less time passed than the samples take that were received."""
    elapsed, received = after.time - before.time, after.received - before.received - 1
    return elapsed < 0 or elapsed < received * PERIOD * (1 - PERIOD_TOLERANCE)


def _crossing(jumps: Iterable[Jump], before: Anchor, after: Anchor) -> Jump | None:
    """Return the jump of counters at which time may have jumped, too, between two anchors."""
    between = [jump for jump in jumps if before.sample < jump.after and jump.before < after.sample]
    if not _restarted(before, after):
        return max(between, key=lambda jump: jump.after - jump.before, default=None)
    # The device counts from 0 when it is switched on, and so does its clock.
    possible = [jump for jump in between if after.time - (after.sample - jump.after) * PERIOD
                >= jump.sequence * PERIOD]
    return min(possible, key=lambda jump: (not jump.power_on, jump.sequence), default=None)
