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
ROUNDS = 2
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


class _Pass(NamedTuple):
    """Indices of the accepted buckets, and of those before which the path changed."""

    accepted: set[int]
    jumps: set[int]


def smooth(buckets: Sequence[Bucket]) -> OffsetCurve:
    """Return the offset curve of an epoch."""
    begin = buckets[0].time
    if len(buckets) < MIN_BUCKETS:      # the skew is unknown, and most may have been late
        smallest = min(buckets, key=lambda bucket: bucket.offset)
        return OffsetCurve(begin, [Knot(smallest.time, smallest.offset, 0.0)])
    spreads = _spreads(buckets)
    accepted, jumps = _both_ways(buckets, spreads)
    base, kept = buckets[0].offset, sorted(accepted)
    # The smoother sees kept buckets only: a jump applies to the first one at or after it.
    jump_variances = [JUMP_DEVIATION ** 2 * any(previous < jump <= index for jump in jumps)
                      for previous, index in zip([-1, *kept], kept)]
    weights = [1.0] * len(kept)
    for _ in range(ROUNDS):
        states = rts_smooth([
            Measurement(buckets[index].time - begin, buckets[index].measured - base,
                        _variance(buckets[index].gap, spreads[index]) * weight, jump_variance)
            for index, weight, jump_variance in zip(kept, weights, jump_variances)],
            FIRST_DEVIATION ** 2)
        weights = [ABOVE_WEIGHT if buckets[index].measured - base > offset else 1.0
                   for index, (offset, _) in zip(kept, states)]
    return OffsetCurve(begin, [Knot(buckets[index].time, base + round(offset), skew)
                               for index, (offset, skew) in zip(kept, states)])


def _both_ways(buckets: Sequence[Bucket], spreads: Sequence[float]) -> _Pass:
    """Combine a forward and a backward pass."""
    forward = _run(buckets, spreads)
    backward = _run(buckets[::-1], spreads[::-1])
    last = len(buckets) - 1
    accepted = _agreed(forward.accepted, {last - index for index in backward.accepted})
    # A backward pass finds the jump at the last bucket before it.
    jumps = forward.jumps | {last - index + 1 for index in backward.jumps}
    return _Pass(accepted or set(range(len(buckets))), jumps)


def _agreed(forward: set[int], backward: set[int]) -> set[int]:
    """Return the buckets that both passes accepted; or one pass, if the other lost track."""
    both, larger = forward & backward, max(forward, backward, key=len)
    return both if len(both) > len(larger) // 2 else larger


def _run(buckets: Sequence[Bucket], spreads: Sequence[float]) -> _Pass:
    """Run the rules of the tracker over the buckets in the given order."""
    first = buckets[0]
    kalman = OffsetFilter(first.time, first.offset, FIRST_DEVIATION, _slope(buckets),
                          SLOPE_DEVIATION if len(buckets) >= 2 * MIN_BUCKETS else SKEW_DEVIATION)
    accepted, jumps, last_time = set[int](), set[int](), first.time
    late: deque[tuple[int, float]] = deque(maxlen=EQUAL_BUCKETS)
    for index, (bucket, spread) in enumerate(zip(buckets, spreads)):
        kalman.predict(bucket.time)
        variance = _variance(bucket.gap, spread)
        limit = gate(kalman.variance + variance)
        innovation = bucket.measured - kalman.offset(bucket.time)
        if innovation > limit:
            late.append((index, innovation))
            path_changed = len(late) == EQUAL_BUCKETS and nearly_equal(
                [value for _, value in late], spread)
            if not path_changed and abs(bucket.time - last_time) <= PATIENCE:
                continue
            jumps.add(late[0][0])
            accepted |= {late_index for late_index, _ in late}
        elif innovation < -limit and innovation + bucket.gap >= -limit:
            continue                    # no second sample confirms the smallest one
        if abs(innovation) > limit:
            kalman.set_offset(bucket.offset, FIRST_DEVIATION)
        else:
            kalman.correct(innovation, variance)
        accepted.add(index)
        last_time = bucket.time
        late.clear()
    return _Pass(accepted, jumps)


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
