# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the overlapping Allan deviation and its coefficients (IEEE Std 952, annex C).

    N   white noise: the line of slope -1/2, at 1 s
    B   bias instability: the lowest point, divided by sqrt(2 ln 2 / pi)
    K   random walk of the bias: the line of slope +1/2, at 3 s

A record of length T gives T / tau averages over tau, and the deviation a relative standard error
of 1 / sqrt(2 (T / tau - 1)). Coefficients are read where that is 25 % at most, that is up to a
ninth of the record. A line counts if it holds over a decade of tau, and the lowest point if the
curve goes on to three times its tau. So K needs 90 times the tau at which the curve begins to
rise: many minutes for a good sensor. A coefficient that cannot be read carries the reason.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple

from bahrs_driver.protocol.batch import Array
import numpy as np

POINTS = 60                     # averaging times, evenly spaced by their logarithm
MAX_TAU_SHARE = 0.25            # of the record; beyond, there is too little to average
MAX_ERROR = 0.25                # relative standard error of a reliable point
MIN_AVERAGES = 1 + 1 / (2 * MAX_ERROR ** 2)     # of a reliable point
FLICKER_FACTOR = math.sqrt(2 * math.log(2) / math.pi)   # lowest deviation / bias instability
SLOPE_TOLERANCE = 0.2
DECADE = 10.0                   # from the shortest to the longest tau of a line
BEYOND_LOWEST = 3.0             # times the tau of the lowest point that the curve must reach


class Coefficient(NamedTuple):
    """A coefficient in the unit of the data (and seconds), or why it cannot be read."""

    value: float | None
    reason: str = ''


@dataclass(frozen=True)
class AllanDeviation:
    """The curve and its coefficients, in the unit of the data (and seconds)."""

    tau: Array                      # s
    deviation: Array
    relative_error: Array           # one standard deviation
    white_noise: Coefficient        # N, unit * sqrt(s)
    bias_instability: Coefficient   # B, unit
    random_walk: Coefficient        # K, unit / sqrt(s)

    @property
    def reliable(self) -> Array:
        """Points from which coefficients are read."""
        return np.asarray(self.relative_error <= MAX_ERROR)


def allan_deviation(values: Array, period: float) -> AllanDeviation:
    """Compute the deviation of evenly spaced values, period seconds apart."""
    integral = np.cumsum(np.append(0.0, values - values.mean())) * period
    longest = max(1, int(len(values) * MAX_TAU_SHARE))
    longest_reliable = max(1, int(len(values) / MIN_AVERAGES))
    sizes = np.union1d(np.geomspace(1, longest, POINTS).astype(np.int64), longest_reliable)
    deviation = np.array([_deviation(integral, int(size), period) for size in sizes])
    sizes, deviation = sizes[deviation > 0], deviation[deviation > 0]
    error = 1 / np.sqrt(2 * np.maximum(len(values) / sizes - 1, 1))
    tau, reliable = sizes * period, error <= MAX_ERROR
    return AllanDeviation(tau, deviation, error,
                          *_coefficients(tau[reliable], deviation[reliable]))


def _deviation(integral: Array, size: int, period: float) -> float:
    second = integral[2 * size:] - 2 * integral[size:-size] + integral[:-2 * size]
    return float(np.sqrt(np.mean(second ** 2) / 2)) / (size * period)


def _coefficients(tau: Array, deviation: Array) -> tuple[Coefficient, Coefficient, Coefficient]:
    """Read N, B and K off the reliable points."""
    if len(tau) < 2 or tau[-1] < DECADE * tau[0]:
        unknown = Coefficient(None, 'rest too short' if len(tau) else 'no noise')
        return unknown, unknown, unknown
    lowest = int(np.argmin(deviation))
    white_noise = _fit_line(tau, deviation, -0.5)
    return (Coefficient(white_noise, '' if white_noise else 'no slope of -1/2'),
            _bias_instability(tau, deviation, lowest),
            _random_walk(tau[lowest:], deviation[lowest:]))


def _bias_instability(tau: Array, deviation: Array, lowest: int) -> Coefficient:
    if lowest == len(tau) - 1:
        return Coefficient(None, f'still falling at {tau[-1]:.0f} s')
    if tau[-1] < BEYOND_LOWEST * tau[lowest]:
        return _too_short(BEYOND_LOWEST * tau[lowest])
    return Coefficient(float(deviation[lowest]) / FLICKER_FACTOR)


def _random_walk(tau: Array, deviation: Array) -> Coefficient:
    """Read K off the points from the lowest one on."""
    slope = np.gradient(np.log(deviation), np.log(tau)) if len(tau) > 1 else np.zeros(1)
    rising = np.flatnonzero(slope > 0.5 - SLOPE_TOLERANCE)
    if not len(rising):
        return Coefficient(None, f'not rising up to {tau[-1]:.0f} s')
    tau, deviation = tau[rising[0]:], deviation[rising[0]:]
    if tau[-1] < DECADE * tau[0]:
        return _too_short(DECADE * tau[0])
    walk = _fit_line(tau, deviation, 0.5)
    return Coefficient(walk and walk * math.sqrt(3), '' if walk else 'no slope of +1/2')


def _too_short(tau: float) -> Coefficient:
    """Give the duration of a record with a reliable point at an averaging time."""
    return Coefficient(None, f'rest too short, needs {math.ceil(MIN_AVERAGES * tau / 60)} min')


def _fit_line(tau: Array, deviation: Array, slope: float) -> float | None:
    """Return the value at 1 s of the line of a slope through the decade that fits it best."""
    x, y = np.log(tau), np.log(deviation)
    smallest, value = SLOPE_TOLERANCE, None
    for begin in range(int(np.searchsorted(tau, tau[-1] / DECADE, side='right'))):
        decade = slice(begin, int(np.searchsorted(tau, DECADE * tau[begin], side='right')))
        difference = abs(float(np.polyfit(x[decade], y[decade], 1)[0]) - slope)
        if difference < smallest:
            smallest, value = difference, float(np.exp(np.mean(y[decade] - slope * x[decade])))
    return value
