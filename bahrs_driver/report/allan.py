# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Overlapping Allan deviation, and what can be read off it (IEEE Std 952, annex C).

    N   white noise: the line of slope -1/2, at 1 s
    B   bias instability: the lowest point, divided by sqrt(2 ln 2 / pi)
    K   random walk of the bias: the line of slope +1/2, at 3 s

Each is told only where the curve has the slope that belongs to it.
"""

from dataclasses import dataclass
import math

from bahrs_driver.report.timeline import Array
import numpy as np

POINTS = 60                     # averaging times, evenly spaced by their logarithm
LONGEST_SHARE = 0.25            # of the data; beyond, there is too little to average
FLAT = math.sqrt(2 * math.log(2) / math.pi)
SLOPE_TOLERANCE = 0.2
FEWEST = 4                      # points in a row that make a slope


@dataclass(frozen=True)
class Allan:
    """The curve and its figures, in the unit of the data (and seconds)."""

    tau: Array                  # s
    deviation: Array
    relative_error: Array       # one standard deviation
    white_noise: float | None           # N, unit * sqrt(s)
    bias_instability: float | None      # B, unit
    random_walk: float | None           # K, unit / sqrt(s)


def allan(values: Array, period: float) -> Allan:
    """Return the deviation of evenly spaced values, period seconds apart."""
    integral = np.concatenate(([0.0], np.cumsum(values - values.mean()))) * period
    longest = max(1, int(len(values) * LONGEST_SHARE))
    sizes = np.unique(np.geomspace(1, longest, POINTS).astype(np.int64))
    deviation = np.array([_deviation(integral, int(size), period) for size in sizes])
    tau = sizes * period
    error = 1 / np.sqrt(2 * np.maximum(len(values) / sizes - 1, 1))
    good = deviation > 0
    tau, deviation, error = tau[good], deviation[good], error[good]
    return Allan(tau, deviation, error, *_figures(tau, deviation))


def _deviation(integral: Array, size: int, period: float) -> float:
    second = integral[2 * size:] - 2 * integral[size:-size] + integral[:-2 * size]
    return float(np.sqrt(np.mean(second ** 2) / 2)) / (size * period)


def _figures(tau: Array, deviation: Array) -> tuple[float | None, float | None, float | None]:
    if len(tau) < 2 * FEWEST:
        return None, None, None
    slope = np.gradient(np.log(deviation), np.log(tau))
    lowest = int(np.argmin(deviation))
    white = _first_run(abs(slope + 0.5) < SLOPE_TOLERANCE)
    walk = _first_run((abs(slope - 0.5) < SLOPE_TOLERANCE) & (np.arange(len(tau)) > lowest))
    inside = lowest < len(tau) - FEWEST
    return (
        None if white is None else float(np.median(deviation[white] * np.sqrt(tau[white]))),
        float(deviation[lowest]) / FLAT if inside else None,
        None if walk is None else float(np.median(deviation[walk] * np.sqrt(3 / tau[walk]))))


def _first_run(wanted: Array) -> slice | None:
    """Return the first stretch of enough points in a row."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], wanted.astype(np.int8), [0]))))
    for begin, end in edges.reshape(-1, 2):
        if end - begin >= FEWEST:
            return slice(int(begin), int(end))
    return None
