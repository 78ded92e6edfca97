# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A Kalman filter of two states: a clock offset, and its rate of change, the skew.

The process noise depends on the temperature. At an even temperature the skew hardly changes, and
a long memory makes it accurate enough to extrapolate; while the device warms up the skew changes
all the time, and with a long memory the offset lags behind. So a filter may have two process
models, each with its own state: after every measurement, a model that predicted it badly loses
weight, and the estimate is the weighted mean (an interacting multiple model filter).
"""

from collections.abc import Sequence
import math
from typing import NamedTuple

from bahrs_driver.units import NS_PER_S

SKEW_LIMIT = 250e-6
OFFSET_WALK = 300.0 ** 2 / NS_PER_S     # ns^2 per ns: 0.3 us per root second
MIN_LOG_LIKELIHOOD = -25.0              # keeps each model possible


class ProcessModel(NamedTuple):
    """The random walk of the skew, and how likely another model holds at the next measurement."""

    skew_walk: float            # variance per ns
    transition_probability: float = 0.0


def process_model(ppm: float, transition_probability: float = 0.0) -> ProcessModel:
    """Return the model of a skew that walks by so many ppm per root second."""
    return ProcessModel((ppm * 1e-6) ** 2 / NS_PER_S, transition_probability)


SINGLE_MODEL = (process_model(0.1),)


class OffsetState:
    """Offset and skew by one model, with their covariance. Offsets in ns."""

    __slots__ = ('offset', 'p00', 'p01', 'p11', 'skew')

    def __init__(self, offset: float, skew: float, p00: float, p01: float, p11: float) -> None:
        self.offset, self.skew = offset, skew
        self.p00, self.p01, self.p11 = p00, p01, p11

    def predict(self, elapsed: int, skew_walk: float) -> None:
        """Extrapolate by some ns, of either sign."""
        self.offset += self.skew * elapsed
        self.p00 += elapsed * (2 * self.p01 + elapsed * self.p11) + OFFSET_WALK * abs(elapsed)
        self.p01 += elapsed * self.p11
        self.p11 += skew_walk * abs(elapsed)

    def correct(self, offset: float, variance: float) -> float:
        """Update with a measurement of the offset; return its likelihood."""
        total, innovation = self.p00 + variance, offset - self.offset
        gain, skew_gain = self.p00 / total, self.p01 / total
        self.offset += gain * innovation
        self.skew = max(-SKEW_LIMIT, min(SKEW_LIMIT, self.skew + skew_gain * innovation))
        self.p11 -= skew_gain * self.p01
        self.p01 *= 1 - gain
        self.p00 *= 1 - gain
        return math.exp(max(MIN_LOG_LIKELIHOOD, -innovation ** 2 / total / 2)) / math.sqrt(total)


def mean(states: Sequence[OffsetState], weights: Sequence[float]) -> OffsetState:
    """Return the state with the mean and covariance of a weighted mixture."""
    offset = sum(w * s.offset for w, s in zip(weights, states))
    skew = sum(w * s.skew for w, s in zip(weights, states))
    p00 = p01 = p11 = 0.0
    for w, s in zip(weights, states):
        by, skew_by = s.offset - offset, s.skew - skew
        p00 += w * (s.p00 + by * by)
        p01 += w * (s.p01 + by * skew_by)
        p11 += w * (s.p11 + skew_by * skew_by)
    return OffsetState(offset, skew, p00, p01, p11)


class OffsetFilter:
    """
    Estimates an offset in ns at a time in ns, and its skew.

    The offset is stored as an integer base plus a small float, which keeps its precision however
    long the clocks have run.
    """

    __slots__ = ('_base', '_mean', '_models', '_states', '_weights', 'time')

    def __init__(self, time: int, offset: int, deviation: float, skew: float = 0.0,
                 skew_deviation: float = 100e-6,
                 models: Sequence[ProcessModel] = SINGLE_MODEL) -> None:
        """Start with an offset and a skew, each with its standard deviation; one or two models."""
        self.time = time
        self._models = models
        self._states = [OffsetState(0.0, skew, 0.0, 0.0, skew_deviation ** 2) for _ in models]
        durations = [1 / model.transition_probability if model.transition_probability else 1.0
                     for model in models]
        self._weights = [duration / sum(durations) for duration in durations]
        self.set_offset(offset, deviation)

    def set_offset(self, offset: int, deviation: float) -> None:
        """Replace the offset at the present time, and keep the skew."""
        self._base = offset
        for state in self._states:
            state.offset, state.p00, state.p01 = 0.0, deviation ** 2, 0.0
        self._mean = mean(self._states, self._weights)

    @property
    def skew(self) -> float:
        """Rate of change of the offset, in ns per ns."""
        return self._mean.skew

    @property
    def variance(self) -> float:
        """Variance of the offset, in ns^2."""
        return self._mean.p00

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""
        return math.sqrt(self._mean.p11)

    def offset(self, time: int) -> int:
        """Return the offset at a time."""
        state = self._mean
        return self._base + round(state.offset + state.skew * (time - self.time))

    def predict(self, time: int) -> None:
        """Extrapolate to a time."""
        elapsed = time - self.time
        self.time = time
        for state, model in zip(self._states, self._models):
            state.predict(elapsed, model.skew_walk)
        self._mean = mean(self._states, self._weights)

    def correct(self, innovation: float, variance: float) -> None:
        """Update with a measurement at the present time, given as its difference to the offset."""
        measured = self._mean.offset + innovation
        self._mix()
        likelihoods = [weight * state.correct(measured, variance)
                       for weight, state in zip(self._weights, self._states)]
        self._weights = [value / sum(likelihoods) for value in likelihoods]
        self._mean = mean(self._states, self._weights)

    def _mix(self) -> None:
        """Mix the states of both models by the probability of a transition between them."""
        if len(self._states) == 1:
            return
        first, second = self._weights
        leave, enter = (model.transition_probability for model in self._models)
        paths = [(first * (1 - leave), second * enter), (first * leave, second * (1 - enter))]
        states, self._weights = self._states, [sum(path) for path in paths]
        self._states = [mean(states, [part / sum(path) for part in path]) for path in paths]
