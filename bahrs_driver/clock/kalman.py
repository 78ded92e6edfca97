# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A Kalman filter of two states: an offset that grows with time, and its rate, the skew."""

from bahrs_driver.clock.units import NANOSECONDS

SKEW_LIMIT = 250e-6
OFFSET_WALK = 300.0 ** 2 / NANOSECONDS          # ns^2 for each ns: 0.3 us a root second
SKEW_WALK = 0.1e-6 ** 2 / NANOSECONDS           # for each ns: 0.1 ppm a root second


class OffsetFilter:
    """
    Estimates an offset in ns at a time in ns, and its skew.

    The offset is kept as a whole number and a small rest, so that nothing is lost to rounding
    however long the clocks have run.
    """

    __slots__ = ('_base', '_p00', '_p01', '_p11', '_rest', 'skew', 'time')

    def __init__(self, time: int, offset: int, deviation: float,
                 skew: float = 0.0, skew_deviation: float = 100e-6) -> None:
        """Start with what is known: an offset and a skew, each with its standard deviation."""
        self.time = time
        self.skew = skew
        self._p11 = skew_deviation ** 2
        self.set_offset(offset, deviation)

    def set_offset(self, offset: int, deviation: float) -> None:
        """Take another offset for the present time, and keep the skew."""
        self._base, self._rest = offset, 0.0
        self._p00, self._p01 = deviation ** 2, 0.0

    @property
    def variance(self) -> float:
        """Return the variance of the offset, in ns^2."""
        return self._p00

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""
        return float(self._p11 ** 0.5)

    def offset(self, time: int) -> int:
        """Return the offset at a time."""
        return self._base + round(self._rest + self.skew * (time - self.time))

    def predict(self, time: int) -> None:
        """Go on to a time."""
        elapsed = time - self.time
        self.time = time
        self._rest += self.skew * elapsed
        self._p00 += elapsed * (2 * self._p01 + elapsed * self._p11) + OFFSET_WALK * abs(elapsed)
        self._p01 += elapsed * self._p11
        self._p11 += SKEW_WALK * abs(elapsed)

    def correct(self, innovation: float, variance: float) -> None:
        """Take a measurement of the offset at the present time, as its difference to ours."""
        total = self._p00 + variance
        gain, skew_gain = self._p00 / total, self._p01 / total
        self._rest += gain * innovation
        self.skew = max(-SKEW_LIMIT, min(SKEW_LIMIT, self.skew + skew_gain * innovation))
        self._p11 -= skew_gain * self._p01
        self._p01 *= 1 - gain
        self._p00 *= 1 - gain
