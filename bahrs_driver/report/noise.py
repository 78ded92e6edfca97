# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Analyze the noise of a device at rest: statistics, spectral lines and Allan deviation."""

from collections.abc import Iterable, Iterator, Sequence
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
Row = tuple[str, list[str]]


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


def table_rows(noise: RestNoise) -> list[Row]:
    """Return the rows of a table: name with unit, and the values of x, y and z as texts."""
    degrees = math.degrees(1)
    return [
        *_rows('rate', '°/s', noise.rate * degrees, noise.period, noise.rate_allan, (
            ('N, angle random walk [°/√h]', 'white_noise', degrees * 60),
            ('B, bias instability [°/h]', 'bias_instability', DEG_PER_H),
            ('K, rate random walk [°/h/√h]', 'random_walk', DEG_PER_H * 60))),
        *_rows('force', 'm/s²', noise.force, noise.period, noise.force_allan, (
            ('N, velocity random walk [m/s/√h]', 'white_noise', 60.0),
            ('B, bias instability [µg]', 'bias_instability', 1e6 / STANDARD_GRAVITY),
            ('K, random walk [m/s²/√h]', 'random_walk', 60.0)))]


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


def _rows(quantity: str, unit: str, values: Array, period: float, curves: Sequence[AllanDeviation],
          coefficients: Iterable[tuple[str, str, float]]) -> Iterator[Row]:
    """Yield rows; coefficients are (title, attribute of AllanDeviation, factor to its unit)."""
    yield f'{quantity}: mean [{unit}]', [f'{mean:.4f}' for mean in values.mean(axis=0)]
    yield f'{quantity}: standard deviation [{unit}]', [f'{std:.4f}' for std in values.std(axis=0)]
    lines = [find_lines(column, period).strongest for column in values.T]
    yield f'{quantity}: strongest line [Hz]', [
        'none' if frequency is None else f'{frequency:.1f}' for frequency in lines]
    for title, name, factor in coefficients:
        yield f'{quantity}: {title}', [
            reason if value is None else f'{value * factor:.3g}'
            for value, reason in (getattr(curve, name) for curve in curves)]
