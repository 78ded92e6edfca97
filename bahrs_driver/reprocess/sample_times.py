# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time of the samples in a stream whose reads have no host time.

Each time message anchors the count of a sample to a device time. Between two anchors that agree
time is linear: those samples have a certain time, and so have the samples before the first and
after the last anchor, up to the nearest gap in the counters. Two anchors may contradict each
other. The device was restarted (less time passed than the samples in between take), it paused or
so many frames were lost that the counter wrapped (more time passed), or a time message was wrong.
As in the live clock, a single anchor is not trusted against others.

`bahrs decode` uses certain times only. `bahrs convert` needs a time for each sample: it places the
change where the counters jump, or else right before the sample of the second anchor, extrapolates
at the period of the device, and uses the nominal period for a stream without any time message.
"""

from bisect import bisect_right
from collections import deque
from typing import NamedTuple

from bahrs_driver.clock.timeline import PERIOD_TOLERANCE, Timeline
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_S, ROS_TIME_END_S

RESTART_DURATION = NS_PER_S         # assumed
LONGEST_PAUSE = 30 * 86_400 * NS_PER_S      # ns; a clock that is further ahead was set
LATEST_TIME = ROS_TIME_END_S * NS_PER_S
MOST_JUMPS = 1000                   # since the latest anchor
MOST_STRETCHES = 1000               # kept behind the sample that was last asked for
FIRST, LAST = -2 ** 62, 2 ** 62     # counts before and after all others


class Anchor(NamedTuple):
    """The device time of a sample, from a time message."""

    sample: int             # its count
    time: int               # device time in ns
    received: int           # samples received before the time message


class Jump(NamedTuple):
    """A gap in the counters, or a message that the device was switched on."""

    before: int             # count of the sample before
    after: int              # count of the first sample after
    sequence: int           # its counter
    power_on: bool

    @property
    def middle(self) -> int:
        """Return a count far from either, because samples were lost on both sides."""
        return (self.before + self.after) // 2


class Stretch(NamedTuple):
    """Samples whose time is linear, up to the begin of the next stretch."""

    begin: int              # count of its first sample
    sample: int             # count of a sample whose time is known
    time: int               # device time of that sample, in ns
    elapsed: int            # ns of so many samples
    samples: int
    offset: int = 0         # ROS time minus device time, in ns

    def time_of(self, count: int) -> int:
        """Return the device time of a sample."""
        return self.time + (count - self.sample) * self.elapsed // self.samples


class Span(NamedTuple):
    """Counts of samples with a certain time, both included."""

    first: int
    last: int


class SampleTimes:
    """Computes the device time of each sample from that of some samples."""

    def __init__(self, period: int) -> None:
        """Expect samples of a nominal period in ns."""
        self._period = period
        self.epochs = 0
        self.rejected = 0                   # anchors that contradicted
        self._begin = FIRST                 # of the next first stretch
        self._jumps: deque[Jump] = deque(maxlen=MOST_JUMPS)     # since the latest anchor
        self._line: Timeline | None = None
        self._candidate: Timeline | None = None
        self._latest = self._doubted = Anchor(FIRST, 0, 0)      # of the line, of the candidate
        self._stretches: list[Stretch] = []
        self._begins: list[int] = []
        self._certain: deque[Span] = deque()

    # A stream as it arrives.

    def jump(self, jump: Jump) -> None:
        """Add a place at which device time may jump."""
        self._jumps.append(jump)

    def anchor(self, anchor: Anchor) -> None:
        """Add the device time of a sample, in the order of the stream."""
        sample, time, _ = anchor
        line, candidate = self._line, self._candidate
        if line and line.agrees(sample, time):
            self._extend(line, anchor)
            self._candidate = None
        elif candidate and candidate.agrees(sample, time) and time != self._doubted.time:
            self._adopt(candidate)
            self._extend(candidate, anchor)
        elif not (candidate and self._doubted[:2] == (sample, time)):
            self.rejected += line is not None
            if candidate and not line and (
                    time > candidate.time_of(sample) or self._crossing(
                        self._doubted, anchor)):
                self._adopt(candidate)
            self._candidate, self._doubted = Timeline(sample, time, self._period), anchor

    def discard(self, count: int) -> None:
        """Discard all anchors: samples up to this one get no certain time any more."""
        self._line = self._candidate = None
        self._latest, self._begin = Anchor(count, 0, 0), count + 1
        self._jumps.clear()

    def decided(self, count: int) -> bool:
        """Whether later anchors cannot change the time of a sample."""
        return count <= self._latest.sample

    def certain_time(self, count: int) -> int | None:
        """Return the device time of a sample in ns, if it is certain; counts must ascend."""
        while self._certain and self._certain[0].last < count:
            self._certain.popleft()
        if not self._certain or count < self._certain[0].first:
            return None
        passed = bisect_right(self._begins, count) - 1
        if passed > MOST_STRETCHES:
            del self._stretches[:passed], self._begins[:passed]
        return self.stretch(count).time_of(count)

    def end(self) -> None:
        """End the stream: the time after the latest anchor is certain up to the next jump."""
        if self._line and self._candidate:
            return
        if self._candidate:
            self._adopt(self._candidate)
        if self._line:
            self._add_certain(self._latest.sample, min(
                (jump.before for jump in self._jumps if jump.before >= self._latest.sample),
                default=LAST))

    # A whole stream.

    def finish(self, start: int | None, first: int) -> None:
        """
        Give each sample a ROS time. first is the count of the first sample.

        start is the ROS time of the first anchor, in ns; without it ROS time is device time.
        """
        if self._candidate and (
                self._line is None or self._crossing(self._latest, self._doubted)):
            self._adopt(self._candidate)
        if self._line:
            self._extend_to_the_end(self._line)
        else:
            self._add(Stretch(FIRST, 0, 0, self._period, 1))
        head = self._stretches[0]
        shift = 0 if start is None else start - head.time
        if start is None and max(
                stretch.time + stretch.offset for stretch in self._stretches) >= LATEST_TIME:
            shift = -head.time
        shift = max(shift, -head.time_of(first))
        self._stretches = [item._replace(offset=item.offset + shift) for item in self._stretches]

    def stretch(self, count: int) -> Stretch:
        """Return the stretch of a sample."""
        return self._stretches[max(0, bisect_right(self._begins, count) - 1)]

    def ros_time(self, count: int) -> int:
        """Return the ROS time of a sample, in ns."""
        stretch = self.stretch(count)
        return stretch.time_of(count) + stretch.offset

    def _extend(self, line: Timeline, anchor: Anchor) -> None:
        """Continue to an anchor that agrees."""
        before = self._latest
        samples, elapsed = anchor.sample - before.sample, anchor.time - before.time
        if samples <= 0:
            return
        self._latest = anchor
        line.accept(anchor.sample, anchor.time)
        self._add_certain(before.sample, anchor.sample)
        last = self._stretches[-1]
        if (last.sample, last.time) == before[:2]:
            self._stretches[-1] = last._replace(elapsed=elapsed, samples=samples)
        elif last.time_of(anchor.sample) != anchor.time:
            self._add(last._replace(begin=before.sample, sample=before.sample, time=before.time,
                                    elapsed=elapsed, samples=samples))
        while self._jumps and self._jumps[0].after <= anchor.sample:
            self._jumps.popleft()

    def _add_certain(self, first: int, last: int) -> None:
        if self._certain and self._certain[-1].last == first:
            first = self._certain.pop().first
        self._certain.append(Span(first, last))

    def _extend_to_the_end(self, line: Timeline) -> None:
        """Extrapolate from the latest anchor at the period of the device."""
        sample, time, _ = self._latest
        last, later = self._stretches[-1], sample + COUNTER_MODULUS
        if last.time_of(later) != line.time_of(later):
            self._add(last._replace(begin=sample, sample=sample, time=time,
                                    elapsed=line.time_of(later) - time, samples=COUNTER_MODULUS))

    def _adopt(self, candidate: Timeline) -> None:
        """Continue from the doubted anchor, in another epoch if there was a line."""
        anchor = self._doubted
        if self._line is None:
            self._certain.append(Span(max(
                (jump.after for jump in self._jumps if jump.after <= anchor.sample),
                default=self._begin), anchor.sample))
            self._add(Stretch(self._begin, anchor.sample, anchor.time, self._period, 1))
            self.epochs += 1
        else:
            self._certain.append(Span(anchor.sample + 1, anchor.sample))
            self._cross(self._line, anchor)
        self._line, self._latest, self._candidate = candidate, anchor, None
        while self._jumps and self._jumps[0].before < anchor.sample:
            self._jumps.popleft()

    def _cross(self, line: Timeline, anchor: Anchor) -> None:
        """Find where time jumps between the latest anchor and another one."""
        self._extend_to_the_end(line)
        last, latest = self._stretches[-1], self._latest
        jump = self._crossing(latest, anchor) or Jump(
            anchor.sample - 1, anchor.sample, 0, False)
        ended = last.time_of(jump.before)
        begins = anchor.time - (anchor.sample - jump.after) * self._period
        new = Stretch(jump.middle if jump.power_on else jump.after, anchor.sample, anchor.time,
                      self._period, 1, last.offset)
        if self._restarted(latest, anchor) or begins - ended > LONGEST_PAUSE:
            self.epochs += 1
            self._add(new._replace(offset=last.offset + ended + RESTART_DURATION - begins))
        elif begins > ended:
            self._add(new)
        else:                   # implausible counters: less time passed than their samples take
            self._add(last._replace(begin=latest.sample, sample=latest.sample, time=latest.time,
                                    elapsed=anchor.time - latest.time,
                                    samples=max(1, anchor.sample - latest.sample)))

    def _add(self, stretch: Stretch) -> None:
        self._stretches.append(stretch)
        self._begins.append(stretch.begin)

    def _restarted(self, before: Anchor, after: Anchor) -> bool:
        """Return whether less time passed than the received samples take."""
        elapsed, received = after.time - before.time, after.received - before.received - 1
        return elapsed < 0 or elapsed < received * self._period * (1 - PERIOD_TOLERANCE)

    def _crossing(self, before: Anchor, after: Anchor) -> Jump | None:
        """Return the jump of the counters at which time may have jumped between two anchors."""
        between = [jump for jump in self._jumps
                   if before.sample < jump.after and jump.before < after.sample]
        if not self._restarted(before, after):
            return max(between, key=lambda jump: jump.after - jump.before, default=None)
        # After power-on the device counts from 0, and so does its clock.
        possible = [jump for jump in between
                    if after.time >= (after.sample - jump.after + jump.sequence) * self._period]
        return min(possible, key=lambda jump: (not jump.power_on, jump.sequence), default=None)
