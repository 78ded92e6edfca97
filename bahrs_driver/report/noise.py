# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Compute and draw spectrum and Allan deviation of a device at rest."""

from collections.abc import Sequence
from dataclasses import dataclass
import math

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.allan import Allan, allan, Coefficient
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.plots import COLOURS, WIDTH
from bahrs_driver.report.rest import longest_rest
from bahrs_driver.report.spectrum import density, lines
from bahrs_driver.report.time_axis import Array
from bahrs_driver.units import STANDARD_GRAVITY
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

MIN_REST = 60.0             # s of rest, below which noise is not analyzed
CLIMB = 2.0                 # m/s; a device that climbs or descends faster is not at rest
MAX_SAMPLES = 2_000_000     # analyzed, nearly three hours
COMPONENTS = ('x', 'y', 'z')
_DEGREES_AN_HOUR = math.degrees(1) * 3600


@dataclass(frozen=True)
class RestNoise:
    """The noise of a device at rest."""

    begin: float                # s
    seconds: float
    period: float
    force: Array                # (n, 3), m/s^2
    rate: Array                 # (n, 3), rad/s
    force_allan: Sequence[Allan]
    rate_allan: Sequence[Allan]


def noise_at_rest(recording: Recording) -> RestNoise | float:
    """Analyze the longest rest; return only its length in s if it is too short."""
    found = _rest(recording)
    if found is None or found[1] < MIN_REST:
        return found[1] if found else 0.0
    part, length = found
    seconds = recording.inertial.seconds[part]
    period = length / (len(seconds) - 1)
    force, rate = (recording.inertial.values[name][part].astype(np.float64)
                   for name in ('specific_force', 'angular_rate'))
    return RestNoise(float(seconds[0]), length, period, force, rate,
                     [allan(column, period) for column in force.T],
                     [allan(column, period) for column in rate.T])


def figures(noise: RestNoise) -> list[tuple[str, list[str]]]:
    """Return rows of a table: the name of a figure, and its value for x, y and z."""
    return [
        ('rate: mean [°/s]', _each(math.degrees(1) * noise.rate.mean(axis=0), '.4f')),
        ('rate: standard deviation [°/s]', _each(math.degrees(1) * noise.rate.std(axis=0), '.4f')),
        ('rate: strongest line [Hz]', _strongest(noise.rate, noise.period)),
        ('rate: N, angle random walk [°/√h]', _read(
            noise.rate_allan, 'white_noise', math.degrees(1) * 60)),
        ('rate: B, bias instability [°/h]', _read(
            noise.rate_allan, 'bias_instability', _DEGREES_AN_HOUR)),
        ('rate: K, rate random walk [°/h/√h]', _read(
            noise.rate_allan, 'random_walk', _DEGREES_AN_HOUR * 60)),
        ('force: mean [m/s²]', _each(noise.force.mean(axis=0), '.4f')),
        ('force: standard deviation [m/s²]', _each(noise.force.std(axis=0), '.4f')),
        ('force: strongest line [Hz]', _strongest(noise.force, noise.period)),
        ('force: N, velocity random walk [m/s/√h]', _read(noise.force_allan, 'white_noise', 60)),
        ('force: B, bias instability [µg]', _read(
            noise.force_allan, 'bias_instability', 1e6 / STANDARD_GRAVITY)),
        ('force: K, random walk [m/s²/√h]', _read(noise.force_allan, 'random_walk', 60)),
    ]


def remarks(noise: RestNoise) -> list[str]:
    """Return remarks about the lines of the spectrum."""
    half_rate = 0.5 / noise.period
    found = [(f'{what} {name}', lines(column, noise.period))
             for what, values in (('specific force', noise.force), ('angular rate', noise.rate))
             for name, column in zip(COMPONENTS, values.T)]
    sentences = []
    if any(line.strongest for _, line in found):
        sentences.append(f'A line may be an alias: with {2 * half_rate:.0f} samples a second, a '
                         f'vibration above {half_rate:.0f} Hz shows at a lower frequency.')
    if at_half_rate := [what for what, line in found if line.at_half_rate]:
        sentences.append(f'The line at {half_rate:.0f} Hz, half the sample rate, is left out '
                         f'({", ".join(at_half_rate)}): its true frequency cannot be known.')
    return sentences


def spectrum(noise: RestNoise) -> Figure:
    """Draw the spectral density of force and rate, with half the sample rate dotted."""
    figure, (left, right) = _pair()
    for axes, values, unit, what in (
            (left, noise.force, 'm/s²', 'specific force'),
            (right, noise.rate * math.degrees(1), '°/s', 'angular rate')):
        for colour, name, column in zip(COLOURS, COMPONENTS, values.T):
            frequency, found = density(column, noise.period)
            if found.any():
                axes.loglog(frequency, found, color=colour, lw=0.8, label=name)
        if axes.lines:
            axes.axvline(0.5 / noise.period, color='#888888', lw=0.8, ls=':')
        low, high = axes.get_ylim()
        axes.set_ylim(low / 2, high * 2)
        _mark_if_empty(axes)
        axes.set_ylabel(f'{what} [{unit}/√Hz]')
        axes.set_xlabel('frequency [Hz]')
        _legend(axes)
    return figure


def deviation(noise: RestNoise) -> Figure:
    """Draw the Allan deviation of force and rate, with its uncertainty."""
    figure, (left, right) = _pair()
    for axes, curves, factor, unit, what in (
            (left, noise.force_allan, 1.0, 'm/s²', 'specific force'),
            (right, noise.rate_allan, _DEGREES_AN_HOUR, '°/h', 'angular rate')):
        for colour, name, curve in zip(COLOURS, COMPONENTS, curves):
            value = curve.deviation * factor
            if not len(value):
                continue
            certain = curve.reliable
            axes.loglog(curve.tau[certain], value[certain], color=colour, lw=1.4, label=name)
            axes.loglog(curve.tau, value, color=colour, lw=0.5)
            error = np.minimum(curve.relative_error, 0.9)
            axes.fill_between(curve.tau, value * (1 - error), value * (1 + error), color=colour,
                              alpha=0.15, lw=0)
        _slope(axes, curves, factor)
        _mark_if_empty(axes)
        axes.set_ylabel(f'{what} [{unit}]')
        axes.set_xlabel('averaging time τ [s]')
        _legend(axes)
    return figure


def _strongest(values: Array, period: float) -> list[str]:
    """Return the frequency of the strongest line of each component, if any."""
    found = [lines(column, period).strongest for column in values.T]
    return ['none' if frequency is None else f'{frequency:.1f}' for frequency in found]


def _slope(axes: Axes, curves: Sequence[Allan], factor: float) -> None:
    """Draw the line of white noise beside the curves."""
    known = [curve.white_noise.value for curve in curves if curve.white_noise.value]
    if known:
        tau = next(curve.tau for curve in curves if len(curve.tau))[[0, -1]]
        axes.loglog(tau, np.median(known) * factor / np.sqrt(tau), color='#888888', lw=0.8,
                    ls='--', label='N/√τ')


def _legend(axes: Axes) -> None:
    if axes.lines:
        axes.legend(frameon=False, ncols=4, loc='lower right', bbox_to_anchor=(1.0, 0.98))


def _mark_if_empty(axes: Axes) -> None:
    if not axes.lines:
        axes.text(0.5, 0.5, 'all values are the same', transform=axes.transAxes, ha='center')


def _pair() -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(WIDTH, 3.6), layout='constrained')
    axes: list[Axes] = figure.subplots(1, 2, squeeze=False)[0].tolist()
    for each in axes:
        each.grid(True, which='major', color='#dddddd', lw=0.6)
        each.spines[['top', 'right']].set_visible(False)
    return figure, axes


def _rest(recording: Recording) -> tuple[slice, float] | None:
    signals = recording.inertial
    force, rate = (np.where(known, signals.values[name], np.nan) for name, known in (
        ('specific_force', _available(signals.health[:, :3])),
        ('angular_rate', _available(signals.health[:, 3:]))))
    force[_climbs(recording)] = np.nan
    rest = longest_rest(signals.seconds, force, rate)
    part = slice(rest.begin, min(rest.end, rest.begin + MAX_SAMPLES))
    if part.stop - part.start < 2:
        return None
    seconds = signals.seconds[part]
    return part, float(seconds[-1] - seconds[0])


def _climbs(recording: Recording) -> Array:
    """Return for each inertial sample whether the device climbs or descends."""
    # Force and rate of a steady climb are those at rest.
    signals, seconds = recording.navigation, recording.inertial.seconds
    known = _available(signals.health[:, signals.names.index('velocity_down')])
    fast = known & (abs(signals.values['velocity_down']) > CLIMB)
    if not len(fast):
        return np.zeros(len(seconds), bool)
    return np.asarray(fast[np.searchsorted(signals.seconds, seconds).clip(max=len(fast) - 1)])


def _available(health: Array) -> Array:
    return np.isin(health, (Integrity.SAFE, Integrity.INTEGRITY_RISK))


def _each(values: Array, precision: str) -> list[str]:
    return [format(value, precision) for value in values]


def _read(curves: Sequence[Allan], name: str, factor: float) -> list[str]:
    return [_cell(getattr(curve, name), factor) for curve in curves]


def _cell(coefficient: Coefficient, factor: float) -> str:
    value, reason = coefficient
    return reason if value is None else f'{value * factor:.3g}'
