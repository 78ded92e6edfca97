# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The live estimate: host time for device time, from nothing but the arrival of samples.

Every sample has a device time d and a bound b: it was sent at host time b at the latest. b - d is
the offset between the clocks plus a delay that is never negative: the adapter's timer, the host's
scheduler, a busy line. So the offset is not the mean of b - d, which moves with the load, but its
lower envelope. The delay of even the fastest sample cannot be measured one-way, and is part of
the offset.

An envelope must forget, because the clocks drift, and must not trust a single sample, because one
that seems too early (a corrupted counter, a wrong time message) would bend it for a long time. So:

*   Samples are gathered in buckets of 0.05 s at the start, growing to 0.5 s. Of a bucket only the
    two smallest residuals m1 <= m2 count, relative to the present estimate. The true minimum is
    about as far below m1 as m1 is below m2; a wide gap gives no such information.
*   A Kalman filter of offset and skew takes one measurement per bucket. It has two process models:
    one for a clock at an even temperature, whose skew is then known well enough to extrapolate
    while no sample can be trusted, and one for a clock that warms up. The variance of a
    measurement follows from the latest gaps m2 - m1: small for an adapter that is often read
    within a frame, large for one that is not.
*   A measurement above the gate means that the host was late, and is rejected; unless that lasts
    for a minute, or ten buckets have the same value: then the path has changed. Its own wide gap
    does not widen the gate: that is typical of a host that is late all the time.
*   A measurement below the gate means that all samples before were late, and is followed at once;
    but only if the second smallest residual confirms it. Far below, it does not wait for the end
    of its bucket.

During the first half second the estimate follows the running minimum, and exists at once. If the
host was late at the start, the first samples waited in a buffer, and each shows better than the
one before how late all of them were: the estimate follows until the minimum falls no more.
"""

from collections import deque
from collections.abc import Collection
import math

from bahrs_driver.clock.estimation.kalman import OffsetFilter, process_model
from bahrs_driver.units import NS_PER_MS, NS_PER_S, NS_PER_US

FIRST_SPAN = NS_PER_S // 2
NOTABLE_FALL = NS_PER_MS                # of the minimum
SHORTEST_BUCKET, LONGEST_BUCKET = NS_PER_S // 20, NS_PER_S // 2
BUCKET_GROWTH = 0.1                     # of the time since the start
CLOSE_GAP = 60 * NS_PER_US              # the most by which the minimum may be extrapolated
WIDEST_GAP = NS_PER_MS                  # wider gaps count as this wide
LEAST_DEVIATION = 8 * NS_PER_US
GATE_DEVIATIONS, GATE_MARGIN = 4, 40 * NS_PER_US
SPREAD_WEIGHT = 0.1
ODD_GAP = 3                             # times the usual gap: wider gaps count as this wide
FIRST_DEVIATION = 200 * NS_PER_US       # of the offset after the first span
JUMP_DEVIATION = 100 * NS_PER_US
OUTLIER_GAP = 10 * NS_PER_MS            # a wider gap: the first minimum is an outlier
READY_AFTER = 70 * NS_PER_MS            # longer than an adapter or a busy line delays a byte
PATIENCE = 60 * NS_PER_S
# At an even temperature, and while the temperature changes.
PROCESS_MODELS = (process_model(0.03, transition_probability=0.002),
                  process_model(0.5, transition_probability=0.05))
EQUAL_BUCKETS = 10                      # late by the same amount: the path has changed


def gate(variance: float) -> float:
    """Return the largest plausible innovation, in ns, of this variance."""
    return GATE_DEVIATIONS * math.sqrt(variance) + GATE_MARGIN


def nearly_equal(innovations: Collection[float], spread: float) -> bool:
    """Return whether innovations differ by no more than the usual noise."""
    width = GATE_MARGIN + GATE_DEVIATIONS * (LEAST_DEVIATION + spread)
    return max(innovations) - min(innovations) < width


class Tracker:
    """Estimates host time for device time while samples arrive; implements `Estimate`."""

    def __init__(self) -> None:
        self.rejected = 0               # measurements
        self.spread = 0.0               # ns
        self._skew, self._skew_deviation = 0.0, 100e-6
        self._filter: OffsetFilter | None = None
        self._in_first_span = True
        self._begin = self._latest = self._accepted = 0     # device times
        self._bucket_end = self._lowest_time = 0
        self._lowest = self._second = math.inf
        self._fall = 0.0                # of the minimum since the last notable fall
        self._late: deque[float] = deque(maxlen=EQUAL_BUCKETS)

    def restart(self) -> None:
        """Discard the offset and keep the skew: the device's clock was set to another time."""
        if self._filter and not self._in_first_span:
            self._skew, self._skew_deviation = self._filter.skew, self._filter.skew_deviation
        self._filter = None
        self._late.clear()

    @property
    def started(self) -> bool:
        """Whether there is an estimate."""
        return self._filter is not None

    @property
    def ready(self) -> bool:
        """Whether more than the first samples support the estimate."""
        return self._filter is not None and self._latest - self._begin >= READY_AFTER

    @property
    def rough(self) -> bool:
        """Whether the estimate may still be late by the longest delay of an adapter."""
        return self._in_first_span

    @property
    def skew(self) -> float:
        """How much faster host time runs than device time, in ns per ns."""
        return self._filter.skew if self._filter else self._skew

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""
        return self._filter.skew_deviation if self._filter else self._skew_deviation

    def host_time(self, device: int) -> int:
        """Return the host time of a device time. The estimate must have started."""
        assert self._filter
        return device + self._filter.offset(device)

    def feed(self, device: int, bound: int) -> None:
        """Add a sample: its device time, and the latest host time at which it was sent."""
        kalman = self._filter
        self._latest = device
        if kalman is None:
            self._start(device, bound)
            return
        if device >= self._bucket_end:
            self._close_bucket(kalman, device)
        residual = bound - device - kalman.offset(device)
        if residual < self._second:
            if residual < self._lowest:
                self._second, self._lowest = self._lowest, residual
                self._lowest_time = device
                if self._in_first_span and residual < 0:
                    self._follow_minimum(kalman, residual)
            else:
                self._second = residual
            if self._second < -NOTABLE_FALL and not self._in_first_span:
                self._close_bucket(kalman, device)

    def _start(self, device: int, bound: int) -> None:
        self._filter = OffsetFilter(
            device, bound - device, FIRST_DEVIATION, self._skew, self._skew_deviation,
            PROCESS_MODELS)
        self._begin = self._accepted = device
        self._in_first_span = True
        self._bucket_end = device + FIRST_SPAN
        self._lowest, self._lowest_time = 0.0, device
        self._second, self._fall = math.inf, 0.0

    def _follow_minimum(self, kalman: OffsetFilter, residual: float) -> None:
        kalman.set_offset(round(kalman.offset(kalman.time) + residual), FIRST_DEVIATION)
        self._second -= residual
        self._lowest = 0.0
        self._fall -= residual
        if self._fall > NOTABLE_FALL:
            self._fall = 0.0
            self._bucket_end = max(self._bucket_end, self._lowest_time + READY_AFTER)

    def _open_bucket(self, device: int) -> None:
        age = device - self._begin
        length = max(SHORTEST_BUCKET, min(LONGEST_BUCKET, int(BUCKET_GROWTH * age)))
        self._bucket_end = device + length
        self._lowest = self._second = math.inf
        self._lowest_time = device

    def _close_bucket(self, kalman: OffsetFilter, device: int) -> None:
        lowest, second = self._lowest, self._second
        if self._in_first_span:
            self._end_first_span(kalman, second)
        elif lowest < math.inf:
            self._measure(kalman, lowest, second)
        self._open_bucket(device)

    def _end_first_span(self, kalman: OffsetFilter, second: float) -> None:
        kalman.predict(self._lowest_time)
        if OUTLIER_GAP < second < math.inf:
            kalman.set_offset(round(kalman.offset(kalman.time) + second), FIRST_DEVIATION)
        self._in_first_span = False
        self._accepted = kalman.time

    def _measure(self, kalman: OffsetFilter, lowest: float, second: float) -> None:
        gap = min(second - lowest, WIDEST_GAP)
        kalman.predict(self._lowest_time)
        usual = LEAST_DEVIATION ** 2 + 2 * self.spread ** 2
        variance = usual + gap ** 2
        early_gate = gate(kalman.variance + variance)
        measured = lowest - min(gap, CLOSE_GAP)
        if lowest < -early_gate:
            self._handle_early(kalman, lowest, second, early_gate, variance)
        elif measured > gate(kalman.variance + usual):
            self._reject_late(kalman, measured)
        else:
            usual_gap = min(gap, ODD_GAP * (LEAST_DEVIATION + self.spread))
            self.spread += SPREAD_WEIGHT * (usual_gap - self.spread)
            self._accept(kalman, measured, variance)

    def _handle_early(self, kalman: OffsetFilter, lowest: float, second: float,
                      early_gate: float, variance: float) -> None:
        """Jump if the second smallest residual confirms the smallest, else use the second."""
        if second < -early_gate:
            self._jump(kalman, lowest)
            return
        self.rejected += 1
        if second <= early_gate:
            self._accept(kalman, second, variance)

    def _accept(self, kalman: OffsetFilter, measured: float, variance: float) -> None:
        # A sample is more likely late than early, and counts less above the estimate.
        kalman.correct(measured, 2 * variance if measured > 0 else variance)
        self._accepted = kalman.time
        self._late.clear()

    def _reject_late(self, kalman: OffsetFilter, measured: float) -> None:
        self.rejected += 1
        late = self._late
        late.append(measured)
        path_changed = len(late) == EQUAL_BUCKETS and nearly_equal(late, self.spread)
        if path_changed or kalman.time - self._accepted > PATIENCE:
            self._jump(kalman, measured)

    def _jump(self, kalman: OffsetFilter, by: float) -> None:
        kalman.set_offset(round(kalman.offset(kalman.time) + by), JUMP_DEVIATION)
        self._accepted = kalman.time
        self._late.clear()
