# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time of the samples in a stream whose reads have no host time.

Each time message anchors the count of a sample to a device time. Between two anchors that agree
time is linear: those samples have a certain time, and so have the samples before the first and
after the last anchor, up to the nearest gap in the counters. Two anchors may contradict each
other. The device was restarted (less time passed than the samples in between take), it paused or
so many frames were lost that the counter wrapped (more time passed), or a time message was wrong.
As in the live clock, a single anchor is not trusted against others: it begins a candidate for
another timeline, which replaces the present one if the next anchor agrees with it.

`bahrs decode` uses certain times only. `bahrs convert` needs a time for each sample: it places the
change where the counters jump, or else right before the sample of the second anchor, extrapolates
at the period of the device, and uses the nominal period for a stream without any time message.
"""

from bisect import bisect_right
from collections import deque
from typing import NamedTuple

from bahrs_driver.clock.timeline import PERIOD_TOLERANCE, Timeline
from bahrs_driver.reprocess.count_ranges import CountRanges
from bahrs_driver.units import COUNTER_MODULUS, NS_PER_S, ROS_TIME_END_S

RESTART_DURATION = NS_PER_S         # assumed
LONGEST_PAUSE = 30 * 86_400 * NS_PER_S      # ns; a clock that is further ahead was set
LATEST_TIME = ROS_TIME_END_S * NS_PER_S
MOST_JUMPS = 1000                   # since the latest anchor
MOST_SEGMENTS = 1000                # kept behind the sample that was last asked for
FIRST, LAST = -2 ** 62, 2 ** 62     # counts before and after all others


class Anchor(NamedTuple):
    """The device time of a sample, from a time message."""

    sample: int             # its count
    time: int               # device time in ns
    received: int           # samples received before the time message

    def agrees(self, timeline: Timeline | None) -> bool:
        """Return whether there is a timeline and the anchor fits it."""
        return timeline is not None and timeline.agrees(self.sample, self.time)


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


class Segment(NamedTuple):
    """Samples whose time is linear, up to the begin of the next segment."""

    begin: int              # count of its first sample
    sample: int             # count of a sample whose time is known
    time: int               # device time of that sample, in ns
    elapsed: int            # ns of so many samples
    samples: int
    offset: int = 0         # ROS time minus device time, in ns

    def time_of(self, count: int) -> int:
        """Return the device time of a sample."""
        return self.time + (count - self.sample) * self.elapsed // self.samples


class SampleTimes:
    """Computes the device time of each sample from that of some samples."""

    def __init__(self, period: int) -> None:
        """Expect samples of a nominal period in ns."""
        self._period = period
        self.epochs = 0
        self.rejected = 0                   # anchors that contradicted the timeline
        self._begin = FIRST                 # of the first segment after discarded anchors
        self._jumps: deque[Jump] = deque(maxlen=MOST_JUMPS)     # since the latest anchor
        self._timeline: Timeline | None = None
        self._latest = Anchor(FIRST, 0, 0)              # of the timeline
        self._candidate: Timeline | None = None
        self._contradicting = self._latest              # the only anchor of the candidate
        self._segments: list[Segment] = []              # in ascending order
        self._certain = CountRanges()

    # For a stream as it arrives:

    def add_jump(self, jump: Jump) -> None:
        """Add a place at which device time may jump."""
        self._jumps.append(jump)

    def add_anchor(self, anchor: Anchor) -> None:
        """Add the device time of a sample, in the order of the stream."""
        if anchor.agrees(self._timeline):
            self._extend(anchor)
            self._candidate = None
        elif anchor.agrees(self._candidate) and anchor.time != self._contradicting.time:
            self._adopt_candidate()
            self._extend(anchor)
        elif not self._candidate or self._contradicting[:2] != anchor[:2]:
            self._begin_candidate(anchor)

    def discard_anchors(self, count: int) -> None:
        """Discard all anchors: samples up to this one get no certain time any more."""
        self._timeline = self._candidate = None
        self._latest, self._begin = Anchor(count, 0, 0), count + 1
        self._jumps.clear()

    def is_final(self, count: int) -> bool:
        """Return whether later anchors cannot change the time of a sample."""
        return count <= self._latest.sample

    def certain_time(self, count: int) -> int | None:
        """Return the device time of a sample in ns, None if uncertain; counts must ascend."""
        if not self._certain.contains(count):
            return None
        passed = self._index(count)
        if passed > MOST_SEGMENTS:
            del self._segments[:passed]
        return self.segment(count).time_of(count)

    def end_stream(self) -> None:
        """Make the time after the latest anchor certain up to the next jump."""
        if self._timeline and self._candidate:
            return
        if self._candidate:
            self._adopt_candidate()
        if self._timeline:
            self._certain.add(self._latest.sample, min(
                (jump.before for jump in self._jumps if jump.before >= self._latest.sample),
                default=LAST))

    # For a stream that has ended:

    def assign_ros_times(self, start: int | None, first: int) -> None:
        """
        Give each sample a ROS time. first is the count of the first sample.

        start is the ROS time of the first anchor, in ns; without it ROS time is device time.
        """
        if self._candidate and (
                self._timeline is None or self._find_jump(self._latest, self._contradicting)):
            self._adopt_candidate()
        if self._timeline:
            self._extrapolate(self._timeline)
        else:
            self._segments.append(Segment(FIRST, 0, 0, self._period, 1))
        head, offset = self._segments[0], 0
        if start is not None:
            offset = start - head.time
        elif max(item.time + item.offset for item in self._segments) >= LATEST_TIME:
            offset = -head.time
        offset = max(offset, -head.time_of(first))
        self._segments = [item._replace(offset=item.offset + offset) for item in self._segments]

    def segment(self, count: int) -> Segment:
        """Return the segment of a sample."""
        return self._segments[self._index(count)]

    def ros_time(self, count: int) -> int:
        """Return the ROS time of a sample, in ns."""
        segment = self.segment(count)
        return segment.time_of(count) + segment.offset

    def _index(self, count: int) -> int:
        """Return the index of the segment of a sample, often the last one."""
        if self._segments[-1].begin <= count:
            return len(self._segments) - 1
        return max(0, bisect_right(self._segments, count, key=lambda item: item.begin) - 1)

    def _extend(self, anchor: Anchor) -> None:
        """Continue the timeline to an anchor that agrees."""
        before, last = self._latest, self._segments[-1]
        samples, elapsed = anchor.sample - before.sample, anchor.time - before.time
        if samples <= 0 or not self._timeline:
            return
        self._latest = anchor
        self._timeline.accept(anchor.sample, anchor.time)
        self._certain.add(before.sample, anchor.sample)
        if (last.sample, last.time) == before[:2]:
            self._segments[-1] = last._replace(elapsed=elapsed, samples=samples)
        elif last.time_of(anchor.sample) != anchor.time:
            self._add_segment(before, elapsed, samples)
        while self._jumps and self._jumps[0].after <= anchor.sample:
            self._jumps.popleft()

    def _add_segment(self, anchor: Anchor, elapsed: int, samples: int) -> None:
        """Add a segment that begins at an anchor of the last one."""
        self._segments.append(self._segments[-1]._replace(
            begin=anchor.sample, sample=anchor.sample, time=anchor.time,
            elapsed=elapsed, samples=samples))

    def _extrapolate(self, timeline: Timeline) -> None:
        """Continue from the latest anchor at the period of the device."""
        later = self._latest.sample + COUNTER_MODULUS
        if self._segments[-1].time_of(later) != timeline.time_of(later):
            self._add_segment(self._latest, timeline.time_of(later) - self._latest.time,
                              COUNTER_MODULUS)

    def _begin_candidate(self, anchor: Anchor) -> None:
        """Begin a candidate, instead of the present one, with an anchor that contradicts both."""
        if self._timeline:
            self.rejected += 1
        elif self._candidate and (anchor.time > self._candidate.time_of(anchor.sample)
                                  or self._find_jump(self._contradicting, anchor)):
            self._adopt_candidate()         # it was right, and time jumped after it
        self._candidate = Timeline(anchor.sample, anchor.time, self._period)
        self._contradicting = anchor

    def _adopt_candidate(self) -> None:
        """Replace the timeline by the candidate, in another epoch if there was a timeline."""
        anchor = self._contradicting
        if self._timeline:
            self._add_discontinuity(self._timeline, anchor)
        else:
            self._certain.add(max((jump.after for jump in self._jumps
                                   if jump.after <= anchor.sample), default=self._begin) - 1,
                              anchor.sample)
            self._segments.append(
                Segment(self._begin, anchor.sample, anchor.time, self._period, 1))
            self.epochs += 1
        self._timeline, self._latest, self._candidate = self._candidate, anchor, None
        while self._jumps and self._jumps[0].before < anchor.sample:
            self._jumps.popleft()

    def _add_discontinuity(self, timeline: Timeline, anchor: Anchor) -> None:
        """Find where time jumps between the latest anchor and another one."""
        self._extrapolate(timeline)
        last, latest = self._segments[-1], self._latest
        jump = self._find_jump(latest, anchor) or Jump(anchor.sample - 1, anchor.sample, 0, False)
        ended = last.time_of(jump.before)
        begins = anchor.time - (anchor.sample - jump.after) * self._period
        new = Segment(jump.middle if jump.power_on else jump.after, anchor.sample, anchor.time,
                      self._period, 1, last.offset)
        if self._restarted(latest, anchor) or begins - ended > LONGEST_PAUSE:
            self.epochs += 1
            self._segments.append(new._replace(
                offset=last.offset + ended + RESTART_DURATION - begins))
        elif begins > ended:
            self._segments.append(new)
        else:                   # implausible counters: less time passed than their samples take
            self._add_segment(latest, anchor.time - latest.time,
                              max(1, anchor.sample - latest.sample))

    def _restarted(self, before: Anchor, after: Anchor) -> bool:
        """Return whether less time passed than the received samples take."""
        elapsed, received = after.time - before.time, after.received - before.received - 1
        return elapsed < 0 or elapsed < received * self._period * (1 - PERIOD_TOLERANCE)

    def _find_jump(self, before: Anchor, after: Anchor) -> Jump | None:
        """Return the jump of the counters at which time may have jumped between two anchors."""
        between = [jump for jump in self._jumps
                   if before.sample < jump.after and jump.before < after.sample]
        if not self._restarted(before, after):
            return max(between, key=lambda jump: jump.after - jump.before, default=None)
        # After power-on the device counts from 0, and so does its clock.
        possible = [jump for jump in between
                    if after.time >= (after.sample - jump.after + jump.sequence) * self._period]
        return min(possible, key=lambda jump: (not jump.power_on, jump.sequence), default=None)
