# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time to host time when the whole recording is there: looked at from both sides.

`tracker` must say at once what it believes, from what came before. Afterwards, what came later
tells as much again, and the first seconds are no worse than the others. A survey follows the
recording as the tracker does and keeps the two lowest samples of each bucket; then

*   a forward and a backward pass, each with the tracker's rules, tell which buckets were late. A
    stretch that was late is seen as such from the side on which it ends in an early jump;
*   where one of them finds that the path has changed, the offset may jump;
*   a fixed-interval smoother (Rauch, Tung, Striebel) goes through the others, twice, as buckets
    that lie above the line count for less.
"""

from bisect import bisect_right
from collections import deque
from collections.abc import Iterable, Sequence
import math
from statistics import median
from typing import NamedTuple

from bahrs_driver.clock.estimation.kalman import OffsetFilter
from bahrs_driver.clock.estimation.rauch import Measurement, smoothed
from bahrs_driver.clock.estimation.tracker import (
    CLOSE_GAP, GATE_DEVIATIONS, GATE_MARGIN, LEAST_DEVIATION, PATIENCE, Tracker, WIDEST_GAP,
)
from bahrs_driver.units import NS_PER_MS, NS_PER_S

BUCKET = NS_PER_S // 2
FIRST_DEVIATION = 10 * NS_PER_MS
JUMP_DEVIATION = 10 * NS_PER_MS
EQUAL_BUCKETS = 20
NEIGHBOURS = 10                         # buckets to either side whose gaps tell the spread
ROUNDS = 2
FEW = 5                                 # buckets, or pairs of them, that do not tell the slope
SLOPE_DEVIATION, SKEW_DEVIATION = 20e-6, 100e-6
ABOVE = 4.0                             # on the variance of what lies above the line


class Bucket(NamedTuple):
    """Of a bucket: the device time of its lowest sample, its offset, and the gap to the next."""

    time: int
    offset: int
    gap: float


class Survey(Tracker):
    """A tracker that remembers what a smoother needs: a few numbers for each half second."""

    def __init__(self) -> None:
        super().__init__()
        self._epochs: list[list[Bucket]] = []
        self._index = -1
        self._start_of_bucket, self._slope = 0, 0.0
        self._two: list[tuple[int, int, int]] = []     # residual, device time, offset

    def restart(self) -> None:
        """Forget the offset and keep the skew; the device's clock was set anew."""
        super().restart()
        self._close()
        self._index = -1
        self._epochs.append([])

    def feed(self, device: int, bound: int) -> None:
        """Take a sample: its device time, and the host's time that it was not sent after."""
        super().feed(device, bound)
        if device // BUCKET != self._index:
            self._close()
            self._index = device // BUCKET
            self._start_of_bucket, self._slope = device, self.skew
        # Not from the line that is believed, which may move within the bucket.
        offset = bound - device
        residual = offset - round(self._slope * (device - self._start_of_bucket))
        self._two = sorted([*self._two, (residual, device, offset)])[:2]

    def lines(self) -> 'SmoothedLines':
        """Return what is known now that all was seen."""
        self._close()
        self._index = -1
        return SmoothedLines(_line(buckets) for buckets in self._epochs if buckets)

    def _close(self) -> None:
        if self._two and self._epochs:
            first, *second = self._two
            gap = second[0][0] - first[0] if second else math.inf
            self._epochs[-1].append(Bucket(first[1], first[2], gap))
        self._two = []


class Line:
    """Host time by device time, straight from knot to knot."""

    def __init__(self, begin: int, knots: Sequence[tuple[int, int, float]]) -> None:
        """
        Take device times in ns, ascending, with the offset in ns and the skew at each.

        begin is that of the first sample, which need not have been believed.
        """
        self._begin = begin
        self._knots = knots
        self._times = [time for time, _, _ in knots]

    def offset(self, device: int) -> int:
        """Return host time less device time."""
        index = bisect_right(self._times, device)
        if 0 < index < len(self._knots):
            (before, low, _), (after, high, _) = self._knots[index - 1:index + 1]
            return low + (high - low) * (device - before) // (after - before)
        time, offset, skew = self._knots[index - 1 if index else 0]
        return offset + round(skew * (device - time))

    def begins_at(self, device: int) -> bool:
        """Whether its first samples were of about this device time."""
        return abs(device - self._begin) <= BUCKET

    def skew(self, device: int) -> float:
        """By how much host time runs faster than device time."""
        return self._knots[max(0, bisect_right(self._times, device) - 1)][2]


class SmoothedLines(Tracker):
    """Stands in for a tracker, and knows all beforehand."""

    def __init__(self, lines: Iterable[Line]) -> None:
        super().__init__()
        self._lines = list(lines)
        self._line: Line | None = None
        self._device = 0

    def restart(self) -> None:
        """Another epoch begins; its first sample will tell which."""
        self._line = None

    @property
    def started(self) -> bool:
        """Whether the epoch is known."""
        return self._line is not None

    @property
    def ready(self) -> bool:
        """Whether the epoch is known."""
        return self.started

    @property
    def rough(self) -> bool:
        """Whether the estimate may be late; it is the best that there is."""
        return False

    @property
    def skew(self) -> float:
        """By how much host time runs faster than device time."""
        return self._line.skew(self._device) if self._line else 0.0

    def host_time(self, device: int) -> int:
        """Return the host's time when the device's was this."""
        assert self._line
        self._device = device
        return device + self._line.offset(device)

    def feed(self, device: int, bound: int) -> None:
        """Take a sample, of which only the first of an epoch tells anything."""
        if self._line is None and self._lines:
            # A short line of late samples may lead anywhere, and by chance be near.
            self._line = min(self._lines, key=lambda line: (
                not line.begins_at(device), abs(bound - device - line.offset(device))))


def _line(buckets: list[Bucket]) -> Line:
    if len(buckets) < FEW:      # the skew is unknown, and most may have been late
        lowest = min(buckets, key=lambda bucket: bucket.offset)
        return Line(buckets[0].time, [(lowest.time, lowest.offset, 0.0)])
    spreads = _spreads(buckets)
    forward, jumps = _pass(buckets, spreads)
    backward, jumps_back = _pass(buckets[::-1], spreads[::-1])
    last = len(buckets) - 1
    believed = _both(forward, {last - index for index in backward}) or set(range(len(buckets)))
    # Going backward, the jump is found at the earlier end of what lies behind it.
    breaks = jumps | {last - index + 1 for index in jumps_back}
    base, start = buckets[0].offset, buckets[0].time
    kept = sorted(believed)
    variances = [_variance(buckets[index].gap, spreads[index]) for index in kept]
    weights = [1.0] * len(kept)
    for _ in range(ROUNDS):
        states = smoothed([
            Measurement(buckets[index].time - start, _measured(buckets[index]) - base,
                        variance * weight,
                        JUMP_DEVIATION ** 2 * any(before < at <= index for at in breaks))
            for before, index, variance, weight in zip([-1, *kept], kept, variances, weights)],
            FIRST_DEVIATION ** 2)
        weights = [ABOVE if _measured(buckets[index]) - base > offset else 1.0
                   for index, (offset, _) in zip(kept, states)]
    return Line(start, [(buckets[index].time, base + round(offset), skew)
                        for index, (offset, skew) in zip(kept, states)])


def _both(forward: set[int], backward: set[int]) -> set[int]:
    """Return what both passes believe; or what one does, if the other has lost its way."""
    both, larger = forward & backward, max(forward, backward, key=len)
    return both if len(both) > len(larger) // 2 else larger


def _slope(buckets: list[Bucket]) -> float:
    """Return about how much the offset grows, a ns for each ns, whatever single buckets say."""
    apart = len(buckets) // 2
    return median((later.offset - bucket.offset) / (later.time - bucket.time)
                  for bucket, later in zip(buckets, buckets[apart:])) if apart >= FEW else 0.0


def _measured(bucket: Bucket) -> float:
    """Return the offset that a bucket tells of."""
    return bucket.offset - bucket.gap if bucket.gap < CLOSE_GAP else bucket.offset


def _variance(gap: float, spread: float) -> float:
    if math.isinf(gap):         # nothing tells how late a sample is that is alone
        return FIRST_DEVIATION ** 2
    return LEAST_DEVIATION ** 2 + 2 * spread ** 2 + min(gap, WIDEST_GAP) ** 2


def _spreads(buckets: list[Bucket]) -> list[float]:
    """Return what the gaps about each bucket are."""
    gaps = [min(bucket.gap, WIDEST_GAP) for bucket in buckets]
    return [median(gaps[max(0, index - NEIGHBOURS):index + NEIGHBOURS + 1])
            for index in range(len(gaps))]


def _pass(buckets: list[Bucket], spreads: list[float]) -> tuple[set[int], set[int]]:
    """Return which buckets are believed in this direction, and before which the path changed."""
    first = buckets[0]
    line = OffsetFilter(first.time, first.offset, FIRST_DEVIATION, _slope(buckets),
                        SLOPE_DEVIATION if len(buckets) >= 2 * FEW else SKEW_DEVIATION)
    believed, jumps, accepted = set(), set(), first.time
    late: deque[tuple[int, float]] = deque(maxlen=EQUAL_BUCKETS)
    for index, (bucket, spread) in enumerate(zip(buckets, spreads)):
        line.predict(bucket.time)
        variance = _variance(bucket.gap, spread)
        gate = GATE_DEVIATIONS * math.sqrt(line.variance + variance) + GATE_MARGIN
        innovation = _measured(bucket) - line.offset(bucket.time)
        if innovation > gate:
            late.append((index, innovation))
            if not _changed(late, spread) and abs(bucket.time - accepted) <= PATIENCE:
                continue
            line.set_offset(bucket.offset, FIRST_DEVIATION)
            jumps.add(late[0][0])
            believed |= {each for each, _ in late}
        elif innovation < -gate:
            if innovation + bucket.gap >= -gate:        # its lowest sample is alone
                continue
            line.set_offset(bucket.offset, FIRST_DEVIATION)
        else:
            line.correct(innovation, variance)
        believed.add(index)
        accepted = bucket.time
        late.clear()
    return believed, jumps


def _changed(late: deque[tuple[int, float]], spread: float) -> bool:
    """Whether so many buckets are late by the same that the path must have changed."""
    if len(late) < EQUAL_BUCKETS:
        return False
    values = [value for _, value in late]
    width = GATE_MARGIN + GATE_DEVIATIONS * (LEAST_DEVIATION + spread)
    return max(values) - min(values) < width
