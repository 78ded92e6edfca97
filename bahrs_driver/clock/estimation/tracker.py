# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time to host time, from nothing but when samples arrive.

Every sample has a device time d and a bound b: it was on its way at host time b at the latest.
b - d is the offset between the clocks, plus a delay that is never negative: the adapter's timer,
the host's scheduler, the line that was busy. So the offset is not the mean of b - d, which moves
with the load, but its lower envelope. What even the fastest sample was late by cannot be told
from one side, and is part of the offset.

An envelope must forget, for the clocks drift, and must not believe a single sample, for one that
seems too early (a counter damaged on the way, a wrong time message) would bend it for long. So:

*   Samples are gathered in buckets, from 0.05 s at the start to 0.5 s. Of a bucket only the two
    lowest residuals m1 <= m2 count, taken from the line that is believed so far. The truth lies
    about as far below the first as that lies below the second; a wide gap tells no more of it.
*   A Kalman filter of offset and skew takes one such measurement a bucket. It has two paces: one
    for a clock at an even temperature, whose skew is then known well enough to go on by while
    nothing can be believed, and one for a clock that warms up. A measurement's noise is what
    the gaps m2 - m1 have shown of late: small for an adapter that is often interrupted within a
    frame, large for one that is not.
*   What lies above the gate says that the host was late, and is rejected; unless it stays for a
    minute, or is the same for ten buckets: then the path has changed. A wide gap of its own opens
    no gate for it: that is what a host that is late all the time looks like.
*   What lies below the gate says that all before was late, and is followed at once; but only if
    the second lowest says so too.

The first half second follows the running minimum, so that there is something to go by at once.
"""

from collections import deque
import math

from bahrs_driver.clock.estimation.kalman import OffsetFilter, pace
from bahrs_driver.units import NS_PER_MS, NS_PER_S, NS_PER_US

FIRST_SPAN = NS_PER_S // 2
SHORTEST_BUCKET, LONGEST_BUCKET = NS_PER_S // 20, NS_PER_S // 2
BUCKET_GROWTH = 0.1                     # of the time since the start
CLOSE_GAP = 60 * NS_PER_US              # the most that the truth is taken to lie below
WIDEST_GAP = NS_PER_MS                  # what is wider says no more
LEAST_DEVIATION = 8 * NS_PER_US
GATE_DEVIATIONS, GATE_MARGIN = 4, 40 * NS_PER_US
SPREAD_WEIGHT = 0.1
ODD_GAP = 3                             # times the usual one: wider ones count as this wide
FIRST_DEVIATION = 200 * NS_PER_US       # of the offset after the first span
JUMP_DEVIATION = 100 * NS_PER_US
ALONE = 10 * NS_PER_MS
FIRST_LOOK = 70 * NS_PER_MS             # more than an adapter holds back, or a busy line takes
PATIENCE = 60 * NS_PER_S
# At an even temperature, and while it changes.
PACES = (pace(0.03, leave=0.002), pace(0.5, leave=0.05))
EQUAL_BUCKETS = 10


class Tracker:
    """Estimates host time, in ns, for device time in ns."""

    def __init__(self) -> None:
        self.rejected = 0               # buckets that were not believed
        self.spread = 0.0               # ns
        self._skew, self._skew_deviation = 0.0, 100e-6
        self._filter: OffsetFilter | None = None
        self._in_first_span = True
        self._begin = self._latest = self._accepted = 0     # device times
        self._bucket_end = self._lowest_time = 0
        self._lowest = self._second = math.inf
        self._late: deque[float] = deque(maxlen=EQUAL_BUCKETS)

    def restart(self) -> None:
        """Forget the offset and keep the skew; the device's clock was set anew."""
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
        """Whether there is an estimate, and more than the first samples went into it."""
        return self._filter is not None and self._latest - self._begin >= FIRST_LOOK

    @property
    def rough(self) -> bool:
        """Whether the estimate may still be late by all that an adapter holds back."""
        return self._in_first_span

    @property
    def skew(self) -> float:
        """By how much host time runs faster than device time."""
        return self._filter.skew if self._filter else self._skew

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""
        return self._filter.skew_deviation if self._filter else self._skew_deviation

    def host_time(self, device: int) -> int:
        """Return the host's time when the device's was this. There must be an estimate."""
        assert self._filter
        return device + self._filter.offset(device)

    def feed(self, device: int, bound: int) -> None:
        """Take a sample: its device time, and the host's time that it was not sent after."""
        line = self._filter
        self._latest = device
        if line is None:
            self._start(device, bound)
            return
        if device >= self._bucket_end:
            self._close_bucket(line, device)
        residual = bound - device - line.offset(device)
        if residual < self._second:
            if residual < self._lowest:
                self._second, self._lowest = self._lowest, residual
                self._lowest_time = device
                if self._in_first_span and residual < 0:
                    self._follow(line, device, residual)
            else:
                self._second = residual

    def _start(self, device: int, bound: int) -> None:
        self._filter = OffsetFilter(
            device, bound - device, FIRST_DEVIATION, self._skew, self._skew_deviation, PACES)
        self._begin = self._accepted = device
        self._in_first_span = True
        self._bucket_end = device + FIRST_SPAN
        self._lowest, self._lowest_time = 0.0, device
        self._second = math.inf

    def _follow(self, line: OffsetFilter, device: int, residual: float) -> None:
        line.set_offset(round(line.offset(line.time) + residual), FIRST_DEVIATION)
        self._second -= residual
        self._lowest = 0.0

    def _open_bucket(self, device: int) -> None:
        age = device - self._begin
        length = max(SHORTEST_BUCKET, min(LONGEST_BUCKET, int(BUCKET_GROWTH * age)))
        self._bucket_end = device + length
        self._lowest = self._second = math.inf
        self._lowest_time = device

    def _close_bucket(self, line: OffsetFilter, device: int) -> None:
        lowest, second = self._lowest, self._second
        if self._in_first_span:
            self._end_first_span(line, second)
        elif lowest < math.inf:
            self._measure(line, lowest, second)
        self._open_bucket(device)

    def _end_first_span(self, line: OffsetFilter, second: float) -> None:
        line.predict(self._lowest_time)
        if ALONE < second < math.inf:       # too far below all others to be believed
            line.set_offset(round(line.offset(line.time) + second), FIRST_DEVIATION)
        self._in_first_span = False
        self._accepted = line.time

    def _measure(self, line: OffsetFilter, lowest: float, second: float) -> None:
        gap = min(second - lowest, WIDEST_GAP)
        line.predict(self._lowest_time)
        usual = LEAST_DEVIATION ** 2 + 2 * self.spread ** 2
        variance = usual + gap ** 2
        early, late = (GATE_DEVIATIONS * math.sqrt(line.variance + noise) + GATE_MARGIN
                       for noise in (variance, usual))
        measured = lowest - min(gap, CLOSE_GAP)
        if lowest < -early:
            self._believe_early(line, lowest, second, early, variance)
        elif measured > late:
            self._reject_late(line, measured)
        else:
            usual_gap = min(gap, ODD_GAP * (LEAST_DEVIATION + self.spread))
            self.spread += SPREAD_WEIGHT * (usual_gap - self.spread)
            self._accept(line, measured, variance)

    def _believe_early(self, line: OffsetFilter, lowest: float, second: float, gate: float,
                       variance: float) -> None:
        if second < -gate:
            self._jump(line, lowest)
            return
        self.rejected += 1
        if second <= gate:
            self._accept(line, second, variance)

    def _accept(self, line: OffsetFilter, measured: float, variance: float) -> None:
        line.correct(measured, 2 * variance if measured > 0 else variance)
        self._accepted = line.time
        self._late.clear()

    def _reject_late(self, line: OffsetFilter, measured: float) -> None:
        self.rejected += 1
        late = self._late
        late.append(measured)
        width = GATE_MARGIN + GATE_DEVIATIONS * (LEAST_DEVIATION + self.spread)
        equal = len(late) == EQUAL_BUCKETS and max(late) - min(late) < width
        if equal or line.time - self._accepted > PATIENCE:
            self._jump(line, measured)

    def _jump(self, line: OffsetFilter, by: float) -> None:
        line.set_offset(round(line.offset(line.time) + by), JUMP_DEVIATION)
        self._accepted = line.time
        self._late.clear()
