# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A Kalman filter of two states: an offset that grows with time, and its rate, the skew.

How fast a skew may change depends on what the clock is going through. At an even temperature it
hardly does, and long memory makes it exact enough to go on by alone; while the device warms up
it moves all the time, and long memory makes the offset lag behind. So a filter may have several
paces, each with states of its own: after every measurement the paces that foretold it badly lose
weight, and what the filter says is the weighted mean (an interacting multiple model filter).
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

from bahrs_driver.units import NS_PER_S

SKEW_LIMIT = 250e-6
OFFSET_WALK = 300.0 ** 2 / NS_PER_S             # ns^2 for each ns: 0.3 us a root second
LEAST_LIKELY = -25.0                            # logarithm, so that no pace is ruled out


class Pace(NamedTuple):
    """How fast a skew changes, and how likely another pace holds at the next measurement."""

    skew_walk: float            # variance for each ns
    leave: float = 0.0


def pace(ppm: float, leave: float = 0.0) -> Pace:
    """Return the pace of a skew that walks by so many ppm a root second."""
    return Pace((ppm * 1e-6) ** 2 / NS_PER_S, leave)


ANY = (pace(0.1),)


class State:
    """Offset and skew as one pace has them, with their covariance. Offsets in ns."""

    __slots__ = ('offset', 'p00', 'p01', 'p11', 'skew')

    def __init__(self, offset: float, skew: float, p00: float, p01: float, p11: float) -> None:
        self.offset, self.skew = offset, skew
        self.p00, self.p01, self.p11 = p00, p01, p11

    def predict(self, elapsed: int, skew_walk: float) -> None:
        """Go on by some ns."""
        self.offset += self.skew * elapsed
        self.p00 += elapsed * (2 * self.p01 + elapsed * self.p11) + OFFSET_WALK * abs(elapsed)
        self.p01 += elapsed * self.p11
        self.p11 += skew_walk * abs(elapsed)

    def correct(self, offset: float, variance: float) -> float:
        """Take a measurement of the offset; return how likely it was."""
        total, innovation = self.p00 + variance, offset - self.offset
        gain, skew_gain = self.p00 / total, self.p01 / total
        self.offset += gain * innovation
        self.skew = max(-SKEW_LIMIT, min(SKEW_LIMIT, self.skew + skew_gain * innovation))
        self.p11 -= skew_gain * self.p01
        self.p01 *= 1 - gain
        self.p00 *= 1 - gain
        return math.exp(max(LEAST_LIKELY, -innovation ** 2 / total / 2)) / math.sqrt(total)


def mean(states: Sequence[State], weights: Sequence[float]) -> State:
    """Return one state that stands for several, with the spread of their values in it."""
    offset = sum(w * s.offset for w, s in zip(weights, states))
    skew = sum(w * s.skew for w, s in zip(weights, states))
    p00 = p01 = p11 = 0.0
    for w, s in zip(weights, states):
        by, skew_by = s.offset - offset, s.skew - skew
        p00 += w * (s.p00 + by * by)
        p01 += w * (s.p01 + by * skew_by)
        p11 += w * (s.p11 + skew_by * skew_by)
    return State(offset, skew, p00, p01, p11)


class OffsetFilter:
    """
    Estimates an offset in ns at a time in ns, and its skew.

    The offset is kept as a whole number and a small rest, so that nothing is lost to rounding
    however long the clocks have run.
    """

    __slots__ = ('_base', '_mean', '_paces', '_states', '_weights', 'time')

    def __init__(self, time: int, offset: int, deviation: float, skew: float = 0.0,
                 skew_deviation: float = 100e-6, paces: Sequence[Pace] = ANY) -> None:
        """
        Start with what is known: an offset and a skew, each with its standard deviation.

        There may be one pace, or two that take turns.
        """
        self.time = time
        self._paces = paces
        self._states = [State(0.0, skew, 0.0, 0.0, skew_deviation ** 2) for _ in paces]
        stays = [1 / pace.leave if pace.leave else 1.0 for pace in paces]
        self._weights = [stay / sum(stays) for stay in stays]
        self.set_offset(offset, deviation)

    def set_offset(self, offset: int, deviation: float) -> None:
        """Take another offset for the present time, and keep the skew."""
        self._base = offset
        for state in self._states:
            state.offset, state.p00, state.p01 = 0.0, deviation ** 2, 0.0
        self._mean = mean(self._states, self._weights)

    @property
    def skew(self) -> float:
        """By how much the offset grows, a ns for each ns."""
        return self._mean.skew

    @property
    def variance(self) -> float:
        """Return the variance of the offset, in ns^2."""
        return self._mean.p00

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""
        return math.sqrt(self._mean.p11)

    def offset(self, time: int) -> int:
        """Return the offset at a time."""
        now = self._mean
        return self._base + round(now.offset + now.skew * (time - self.time))

    def predict(self, time: int) -> None:
        """Go on to a time."""
        elapsed = time - self.time
        self.time = time
        for state, pace in zip(self._states, self._paces):
            state.predict(elapsed, pace.skew_walk)
        self._mean = mean(self._states, self._weights)

    def correct(self, innovation: float, variance: float) -> None:
        """Take a measurement of the offset at the present time, as its difference to ours."""
        measured = self._mean.offset + innovation
        self._change_pace()
        likely = [weight * state.correct(measured, variance)
                  for weight, state in zip(self._weights, self._states)]
        self._weights = [value / sum(likely) for value in likely]
        self._mean = mean(self._states, self._weights)

    def _change_pace(self) -> None:
        """Let each state begin as what may have led to it: its own pace, or the other one."""
        if len(self._states) == 1:
            return
        first, second = self._weights
        leave, enter = (pace.leave for pace in self._paces)
        ways = [(first * (1 - leave), second * enter), (first * leave, second * (1 - enter))]
        states, self._weights = self._states, [sum(way) for way in ways]
        self._states = [mean(states, [part / sum(way) for part in way]) for way in ways]
