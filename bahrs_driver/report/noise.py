# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Analyze the noise of a device at rest: statistics, spectral lines and Allan deviation."""

from collections.abc import Sequence
from dataclasses import dataclass
import math

from bahrs_driver.protocol.batch import Array
from bahrs_driver.report.allan import allan_deviation, AllanDeviation
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.rest import Rest
from bahrs_driver.report.spectrum import find_lines
from bahrs_driver.units import STANDARD_GRAVITY
import numpy as np

MIN_REST = 60.0             # s of rest, below which noise is not analyzed
COMPONENTS = ('x', 'y', 'z')
DEG_PER_H = math.degrees(1) * 3600      # of a rad/s


@dataclass(frozen=True)
class RestNoise:
    """Samples of a device at rest, and the Allan deviation of each component."""

    begin: float                # s since the first sample of the recording
    seconds: float
    period: float               # s
    force: Array                # (n, 3), m/s^2
    rate: Array                 # (n, 3), rad/s
    force_allan: Sequence[AllanDeviation]
    rate_allan: Sequence[AllanDeviation]


def analyze_noise(recording: Recording, rest: Rest) -> RestNoise:
    """Analyze the noise during a rest."""
    samples = slice(rest.begin, rest.end)
    period = rest.seconds / (rest.end - rest.begin - 1)
    force, rate = (recording.inertial.values[name][samples].astype(np.float64)
                   for name in ('specific_force', 'angular_rate'))
    return RestNoise(float(recording.inertial.seconds[rest.begin]), rest.seconds, period,
                     force, rate, [allan_deviation(column, period) for column in force.T],
                     [allan_deviation(column, period) for column in rate.T])


def table_rows(noise: RestNoise) -> list[tuple[str, list[str]]]:
    """Return the rows of a table: name with unit, and the values of x, y and z as texts."""
    return [
        ('rate: mean [°/s]', _formatted(math.degrees(1) * noise.rate.mean(axis=0))),
        ('rate: standard deviation [°/s]', _formatted(math.degrees(1) * noise.rate.std(axis=0))),
        ('rate: strongest line [Hz]', _strongest_lines(noise.rate, noise.period)),
        ('rate: N, angle random walk [°/√h]', _coefficients(
            noise.rate_allan, 'white_noise', math.degrees(1) * 60)),
        ('rate: B, bias instability [°/h]', _coefficients(
            noise.rate_allan, 'bias_instability', DEG_PER_H)),
        ('rate: K, rate random walk [°/h/√h]', _coefficients(
            noise.rate_allan, 'random_walk', DEG_PER_H * 60)),
        ('force: mean [m/s²]', _formatted(noise.force.mean(axis=0))),
        ('force: standard deviation [m/s²]', _formatted(noise.force.std(axis=0))),
        ('force: strongest line [Hz]', _strongest_lines(noise.force, noise.period)),
        ('force: N, velocity random walk [m/s/√h]', _coefficients(
            noise.force_allan, 'white_noise', 60)),
        ('force: B, bias instability [µg]', _coefficients(
            noise.force_allan, 'bias_instability', 1e6 / STANDARD_GRAVITY)),
        ('force: K, random walk [m/s²/√h]', _coefficients(
            noise.force_allan, 'random_walk', 60)),
    ]


def remarks(noise: RestNoise) -> list[str]:
    """Return remarks about the lines of the spectrum."""
    nyquist = 0.5 / noise.period
    lines = {f'{quantity} {component}': find_lines(column, noise.period)
             for quantity, values in (('specific force', noise.force),
                                      ('angular rate', noise.rate))
             for component, column in zip(COMPONENTS, values.T)}
    sentences = []
    if any(found.strongest for found in lines.values()):
        sentences.append(f'A line may be an alias: with {2 * nyquist:.0f} samples a second, a '
                         f'vibration above {nyquist:.0f} Hz shows at a lower frequency.')
    if at_nyquist := [signal for signal, found in lines.items() if found.at_nyquist]:
        sentences.append(f'The line at {nyquist:.0f} Hz, half the sample rate, is left out '
                         f'({", ".join(at_nyquist)}): its true frequency cannot be known.')
    return sentences


def _formatted(values: Array) -> list[str]:
    return [f'{value:.4f}' for value in values]


def _strongest_lines(values: Array, period: float) -> list[str]:
    lines = [find_lines(column, period).strongest for column in values.T]
    return ['none' if frequency is None else f'{frequency:.1f}' for frequency in lines]


def _coefficients(curves: Sequence[AllanDeviation], name: str, factor: float) -> list[str]:
    """Return a coefficient of each curve in the unit of the table, or why it has none."""
    return [reason if value is None else f'{value * factor:.3g}'
            for value, reason in (getattr(curve, name) for curve in curves)]
