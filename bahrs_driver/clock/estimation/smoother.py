# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The offset between the clocks in one epoch of a recording, by all of its samples.

`tracker` must decide at once, from earlier samples only. In a recording later samples are known as
well, and the first seconds become as accurate as the others. The input is one bucket per half
second, with the two smallest samples that `smoother_input` kept of it. Then

*   a forward and a backward pass, each by the rules of the tracker, find the buckets that were
    late. A late stretch is recognized from the side on which it ends in an early jump;
*   where a pass finds that the path has changed, the offset may jump;
*   a fixed-interval smoother (Rauch, Tung, Striebel) runs over the other buckets, twice, because
    buckets above the curve get less weight.
"""

from collections import deque
from collections.abc import Sequence
import math
from statistics import median
from typing import NamedTuple

from bahrs_driver.clock.estimation.kalman import OffsetFilter
from bahrs_driver.clock.estimation.rts_smoother import Measurement, rts_smooth
from bahrs_driver.clock.estimation.smoothed_estimate import Knot, OffsetCurve
from bahrs_driver.clock.estimation.tracker import (
    CLOSE_GAP, gate, LEAST_DEVIATION, nearly_equal, PATIENCE, WIDEST_GAP,
)
from bahrs_driver.units import NS_PER_MS

FIRST_DEVIATION = 10 * NS_PER_MS
JUMP_DEVIATION = 10 * NS_PER_MS
EQUAL_BUCKETS = 20                      # late by the same amount: the path has changed
NEIGHBOURS = 10                         # buckets on either side that determine the spread
MIN_BUCKETS = 5                         # or pairs of buckets, to determine a slope
SLOPE_DEVIATION, SKEW_DEVIATION = 20e-6, 100e-6
ABOVE_WEIGHT = 4.0                      # factor on the variance of a bucket above the curve


class Bucket(NamedTuple):
    """The smallest sample of half a second, and its gap to the second smallest in ns."""

    time: int
    offset: int
    gap: float

    @property
    def measured(self) -> float:
        """Return the offset, extrapolated to the minimum if the gap is small."""
        return self.offset - self.gap if self.gap < CLOSE_GAP else self.offset


def smooth(buckets: Sequence[Bucket]) -> OffsetCurve:
    """Return the offset curve of an epoch."""
    begin, base = buckets[0].time, buckets[0].offset
    if len(buckets) < MIN_BUCKETS:      # the skew is unknown, and most may have been late
        smallest = min(buckets, key=lambda bucket: bucket.offset)
        return OffsetCurve(begin, [Knot(smallest.time, smallest.offset, 0.0)])
    measurements = _measurements(buckets)
    return OffsetCurve(begin, [
        Knot(begin + measurement.time, base + round(offset), skew)
        for measurement, (offset, skew) in zip(measurements, _fit(measurements))])


def _measurements(buckets: Sequence[Bucket]) -> list[Measurement]:
    """Return the accepted buckets as measurements, relative to the first bucket."""
    first, spreads = buckets[0], _spreads(buckets)
    accepted, jumps = _accepted_both_ways(buckets, spreads)
    measurements, previous = [], -1
    for index in sorted(accepted):
        bucket = buckets[index]
        # The path may have changed before a rejected bucket between this one and the previous.
        jumped = any(previous < jump <= index for jump in jumps)
        measurements.append(Measurement(
            bucket.time - first.time, bucket.measured - first.offset,
            _variance(bucket.gap, spreads[index]), JUMP_DEVIATION ** 2 * jumped))
        previous = index
    return measurements


def _fit(measurements: Sequence[Measurement]) -> list[tuple[float, float]]:
    """Return offset and skew at each measurement; those above the curve get less weight."""
    curve = rts_smooth(measurements, FIRST_DEVIATION ** 2)
    return rts_smooth([
        item._replace(variance=ABOVE_WEIGHT * item.variance) if item.offset > offset else item
        for item, (offset, _) in zip(measurements, curve)], FIRST_DEVIATION ** 2)


def _accepted_both_ways(buckets: Sequence[Bucket],
                        spreads: Sequence[float]) -> tuple[set[int], set[int]]:
    """Return the indices of accepted buckets and of jumps, by a forward and a backward pass."""
    forward = _Pass(buckets, spreads)
    backward = _Pass(buckets[::-1], spreads[::-1])
    last = len(buckets) - 1
    accepted = _agreed(forward.accepted, {last - index for index in backward.accepted})
    # A backward pass finds the jump at the last bucket before it.
    jumps = forward.jumps | {last - index + 1 for index in backward.jumps}
    return accepted or set(range(len(buckets))), jumps


def _agreed(forward: set[int], backward: set[int]) -> set[int]:
    """Return the buckets that both passes accepted, or those of one if the other lost track."""
    both, larger = forward & backward, max(forward, backward, key=len)
    return both if len(both) > len(larger) // 2 else larger


class _Late(NamedTuple):
    """Index of a late bucket, and its innovation."""

    bucket_index: int
    innovation: float


class _Pass:
    """
    A pass over the buckets, in the given order, by the rules of the tracker.

    `accepted` has the indices of accepted buckets, `jumps` those before which the path changed.
    """

    def __init__(self, buckets: Sequence[Bucket], spreads: Sequence[float]) -> None:
        self.accepted, self.jumps = set[int](), set[int]()
        first = buckets[0]
        self._filter = OffsetFilter(
            first.time, first.offset, FIRST_DEVIATION, _slope(buckets),
            SLOPE_DEVIATION if len(buckets) >= 2 * MIN_BUCKETS else SKEW_DEVIATION)
        self._accepted_time = first.time
        self._late: deque[_Late] = deque(maxlen=EQUAL_BUCKETS)      # since the accepted time
        for index, (bucket, spread) in enumerate(zip(buckets, spreads)):
            self._add(index, bucket, spread)

    def _add(self, index: int, bucket: Bucket, spread: float) -> None:
        kalman = self._filter
        kalman.predict(bucket.time)
        variance = _variance(bucket.gap, spread)
        limit = gate(kalman.variance + variance)
        innovation = bucket.measured - kalman.offset(bucket.time)
        if innovation > limit and not self._add_late(index, bucket, innovation, spread):
            return
        if innovation < -limit <= innovation + bucket.gap:
            return                      # no second sample confirms the smallest one
        if abs(innovation) > limit:
            kalman.set_offset(bucket.offset, FIRST_DEVIATION)
        else:
            kalman.correct(innovation, variance)
        self.accepted.add(index)
        self._accepted_time = bucket.time
        self._late.clear()

    def _add_late(self, index: int, bucket: Bucket, innovation: float, spread: float) -> bool:
        """Add a late bucket; return whether the path has changed, and accept all late ones."""
        late = self._late
        late.append(_Late(index, innovation))
        equal = len(late) == EQUAL_BUCKETS and nearly_equal(
            [item.innovation for item in late], spread)
        if not equal and abs(bucket.time - self._accepted_time) <= PATIENCE:
            return False
        self.jumps.add(late[0].bucket_index)
        self.accepted.update(item.bucket_index for item in late)
        return True


def _slope(buckets: Sequence[Bucket]) -> float:
    """Return the skew as a median of slopes, which single late buckets do not affect."""
    apart = len(buckets) // 2
    return median((later.offset - bucket.offset) / (later.time - bucket.time)
                  for bucket, later in zip(buckets, buckets[apart:])
                  ) if apart >= MIN_BUCKETS else 0.0


def _variance(gap: float, spread: float) -> float:
    if math.isinf(gap):         # a lone sample may be late by any delay
        return FIRST_DEVIATION ** 2
    return LEAST_DEVIATION ** 2 + 2 * spread ** 2 + min(gap, WIDEST_GAP) ** 2


def _spreads(buckets: Sequence[Bucket]) -> list[float]:
    """Return the usual gap around each bucket."""
    gaps = [min(bucket.gap, WIDEST_GAP) for bucket in buckets]
    return [median(gaps[max(0, index - NEIGHBOURS):index + NEIGHBOURS + 1])
            for index in range(len(gaps))]
