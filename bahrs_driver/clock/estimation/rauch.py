# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A fixed-interval smoother (Rauch, Tung, Striebel) of an offset and its rate, the skew.

The model is that of `kalman` with a single pace: the offset walks, and the skew walks.
"""

from collections.abc import Sequence
from typing import NamedTuple

from bahrs_driver.clock.estimation.kalman import OFFSET_WALK, pace

FIRST_SKEW_VARIANCE = 100e-6 ** 2
SKEW_WALK = pace(0.1).skew_walk         # one pace is enough where both sides are seen


class Measurement(NamedTuple):
    """An offset in ns at a time in ns, its variance, and by what it may have jumped before."""

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


def smoothed(measurements: Sequence[Measurement],
             first_variance: float) -> list[tuple[float, float]]:
    """Return offset and skew at each measurement, of which times ascend, by all of them."""
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
    """Return what was expected at each measurement, and what was believed after it."""
    first = measurements[0]
    state, time = _State(first.offset, 0.0, first_variance, 0.0, FIRST_SKEW_VARIANCE), first.time
    predicted, filtered = [], []
    for item in measurements:
        elapsed, time = item.time - time, item.time
        state = _State(
            state.offset + state.skew * elapsed, state.skew,
            state.p00 + elapsed * (2 * state.p01 + elapsed * state.p11)
            + OFFSET_WALK * elapsed + item.jump_variance,
            state.p01 + elapsed * state.p11, state.p11 + SKEW_WALK * elapsed)
        predicted.append(state)
        gain, skew_gain = (value / (state.p00 + item.variance) for value in (state.p00, state.p01))
        innovation = item.offset - state.offset
        state = _State(
            state.offset + gain * innovation, state.skew + skew_gain * innovation,
            state.p00 * (1 - gain), state.p01 * (1 - gain), state.p11 - skew_gain * state.p01)
        filtered.append(state)
    return predicted, filtered


def _step_back(state: _State, expected: _State, later: _State, elapsed: int) -> _State:
    """Return a state that knows also what the next one knows, without its covariance."""
    # C = P F' inverse(P expected), for F = (1 elapsed; 0 1).
    a, b = state.p00 + elapsed * state.p01, state.p01
    c, d = state.p01 + elapsed * state.p11, state.p11
    determinant = expected.p00 * expected.p11 - expected.p01 ** 2
    offset, skew = later.offset - expected.offset, later.skew - expected.skew
    x = (expected.p11 * offset - expected.p01 * skew) / determinant
    y = (expected.p00 * skew - expected.p01 * offset) / determinant
    return state._replace(offset=state.offset + a * x + b * y, skew=state.skew + c * x + d * y)
