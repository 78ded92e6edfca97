# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A fixed-interval smoother (Rauch, Tung, Striebel) of a clock offset and its skew.

The process model is that of `kalman`: the offset and the skew each do a random walk.
"""

from collections.abc import Sequence
from typing import NamedTuple

from bahrs_driver.clock.estimation.kalman import OFFSET_WALK, SINGLE_MODEL

FIRST_SKEW_VARIANCE = 100e-6 ** 2
SKEW_WALK = SINGLE_MODEL[0].skew_walk   # one model suffices with measurements on both sides


class Measurement(NamedTuple):
    """An offset in ns at a time in ns, its variance, and that of a jump right before it."""

    time: int
    offset: float
    variance: float
    jump_variance: float = 0.0


class _State(NamedTuple):
    """Offset and skew, and their covariance."""

    offset: float
    skew: float
    p00: float
    p01: float
    p11: float


def rts_smooth(measurements: Sequence[Measurement],
               first_variance: float) -> list[tuple[float, float]]:
    """Return offset and skew at each measurement by all of them; times must ascend."""
    predicted, filtered = _filter(measurements, first_variance)
    state = filtered[-1]
    found = [(state.offset, state.skew)]
    for index in range(len(filtered) - 2, -1, -1):
        elapsed = measurements[index + 1].time - measurements[index].time
        state = _step_back(filtered[index], predicted[index + 1], state, elapsed)
        found.append((state.offset, state.skew))
    return found[::-1]


def _filter(measurements: Sequence[Measurement],
            first_variance: float) -> tuple[list[_State], list[_State]]:
    """Return the state before and after each measurement."""
    first = measurements[0]
    state, time = _State(first.offset, 0.0, first_variance, 0.0, FIRST_SKEW_VARIANCE), first.time
    predicted, filtered = [], []
    for item in measurements:
        elapsed, time = item.time - time, item.time
        state = _predict(state, elapsed, item.jump_variance)
        predicted.append(state)
        state = _correct(state, item)
        filtered.append(state)
    return predicted, filtered


def _predict(state: _State, elapsed: int, jump_variance: float) -> _State:
    return _State(
        state.offset + state.skew * elapsed, state.skew,
        state.p00 + elapsed * (2 * state.p01 + elapsed * state.p11)
        + OFFSET_WALK * elapsed + jump_variance,
        state.p01 + elapsed * state.p11, state.p11 + SKEW_WALK * elapsed)


def _correct(state: _State, item: Measurement) -> _State:
    gain, skew_gain = (value / (state.p00 + item.variance) for value in (state.p00, state.p01))
    innovation = item.offset - state.offset
    return _State(
        state.offset + gain * innovation, state.skew + skew_gain * innovation,
        state.p00 * (1 - gain), state.p01 * (1 - gain), state.p11 - skew_gain * state.p01)


def _step_back(state: _State, predicted: _State, later: _State, elapsed: int) -> _State:
    """Return the smoothed state before a smoothed one, with its filtered covariance."""
    # C = P F' inverse(P predicted), for F = (1 elapsed; 0 1).
    a, b = state.p00 + elapsed * state.p01, state.p01
    c, d = state.p01 + elapsed * state.p11, state.p11
    determinant = predicted.p00 * predicted.p11 - predicted.p01 ** 2
    offset, skew = later.offset - predicted.offset, later.skew - predicted.skew
    x = (predicted.p11 * offset - predicted.p01 * skew) / determinant
    y = (predicted.p00 * skew - predicted.p01 * offset) / determinant
    return state._replace(offset=state.offset + a * x + b * y, skew=state.skew + c * x + d * y)
