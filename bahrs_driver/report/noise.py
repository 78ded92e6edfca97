# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Spectrum and Allan deviation of a device at rest, and the figures that are read off them."""

from collections.abc import Sequence
from dataclasses import dataclass
import math

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.allan import Allan, allan
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.plots import COLOURS, WIDTH
from bahrs_driver.report.rest import longest_rest
from bahrs_driver.report.timeline import Array
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.mlab import psd
import numpy as np

ENOUGH = 60.0               # s of rest, below which nothing is said of noise
CLIMB = 2.0                 # m/s; a device at rest is not taken to go up or down faster
LONGEST = 2_000_000         # samples looked at, nearly three hours
WELCH = 4096                # samples of each piece of a spectrum
LINE = 3.0                  # times the median density, from which on it is no noise
LOWEST_LINE = 1.0           # Hz
COMPONENTS = ('x', 'y', 'z')
GRAVITY = 9.80665
_DEGREES_AN_HOUR = math.degrees(1) * 3600


@dataclass(frozen=True)
class Noise:
    """What a device at rest shows."""

    begin: float                # s
    seconds: float
    period: float
    force: Array                # (n, 3), m/s^2
    rate: Array                 # (n, 3), rad/s
    force_allan: Sequence[Allan]
    rate_allan: Sequence[Allan]


def noise_at_rest(recording: Recording) -> Noise | float:
    """Look at the longest rest; return but its length in s if it is too short."""
    found = _rest(recording)
    if found is None or found[1] < ENOUGH:
        return found[1] if found else 0.0
    part, length = found
    seconds = recording.inertial.seconds[part]
    period = length / (len(seconds) - 1)
    force, rate = (recording.inertial.values[name][part].astype(np.float64)
                   for name in ('specific_force', 'angular_rate'))
    return Noise(float(seconds[0]), length, period, force, rate,
                 [allan(column, period) for column in force.T],
                 [allan(column, period) for column in rate.T])


def figures(noise: Noise) -> list[tuple[str, list[str]]]:
    """Return rows of a table: what it is, and its value for x, y and z."""
    return [
        ('rate: mean [°/s]', _each(math.degrees(1) * noise.rate.mean(axis=0), '.4f')),
        ('rate: standard deviation [°/s]', _each(math.degrees(1) * noise.rate.std(axis=0), '.4f')),
        ('rate: strongest line [Hz]', _lines(noise.rate, noise.period)),
        ('rate: N, angle random walk [°/√h]', _read(
            noise.rate_allan, 'white_noise', math.degrees(1) * 60)),
        ('rate: B, bias instability [°/h]', _read(
            noise.rate_allan, 'bias_instability', _DEGREES_AN_HOUR)),
        ('rate: K, rate random walk [°/h/√h]', _read(
            noise.rate_allan, 'random_walk', _DEGREES_AN_HOUR * 60)),
        ('force: mean [m/s²]', _each(noise.force.mean(axis=0), '.4f')),
        ('force: standard deviation [m/s²]', _each(noise.force.std(axis=0), '.4f')),
        ('force: strongest line [Hz]', _lines(noise.force, noise.period)),
        ('force: N, velocity random walk [m/s/√h]', _read(noise.force_allan, 'white_noise', 60)),
        ('force: B, bias instability [µg]', _read(
            noise.force_allan, 'bias_instability', 1e6 / GRAVITY)),
        ('force: K, random walk [m/s²/√h]', _read(noise.force_allan, 'random_walk', 60)),
    ]


def spectrum(noise: Noise) -> Figure:
    """Draw the spectral density of force and rate."""
    figure, (left, right) = _pair()
    for axes, values, unit, what in (
            (left, noise.force, 'm/s²', 'specific force'),
            (right, noise.rate * math.degrees(1), '°/s', 'angular rate')):
        for colour, name, column in zip(COLOURS, COMPONENTS, values.T):
            frequency, density = _density(column, noise.period)
            if density.any():
                axes.loglog(frequency, density, color=colour, lw=0.8, label=name)
        low, high = axes.get_ylim()
        axes.set_ylim(low / 2, high * 2)
        _say_if_empty(axes)
        axes.set_ylabel(f'{what} [{unit}/√Hz]')
        axes.set_xlabel('frequency [Hz]')
        _legend(axes)
    return figure


def deviation(noise: Noise) -> Figure:
    """Draw the Allan deviation of force and rate, with its uncertainty."""
    figure, (left, right) = _pair()
    for axes, curves, factor, unit, what in (
            (left, noise.force_allan, 1.0, 'm/s²', 'specific force'),
            (right, noise.rate_allan, _DEGREES_AN_HOUR, '°/h', 'angular rate')):
        for colour, name, curve in zip(COLOURS, COMPONENTS, curves):
            value = curve.deviation * factor
            if not len(value):
                continue
            axes.loglog(curve.tau, value, color=colour, lw=1.2, label=name)
            error = np.minimum(curve.relative_error, 0.9)
            axes.fill_between(curve.tau, value * (1 - error), value * (1 + error), color=colour,
                              alpha=0.15, lw=0)
        _slope(axes, curves, factor)
        _say_if_empty(axes)
        axes.set_ylabel(f'{what} [{unit}]')
        axes.set_xlabel('averaging time τ [s]')
        _legend(axes)
    return figure


def _density(values: Array, period: float) -> tuple[Array, Array]:
    """Return frequencies above 0 (Hz) and the square root of the power density at each."""
    size = min(WELCH, len(values))
    power, frequency = psd(values - values.mean(), NFFT=size, Fs=1 / period, noverlap=size // 2)
    return np.asarray(frequency)[1:-1], np.sqrt(power)[1:-1]     # both ends count half


def _lines(values: Array, period: float) -> list[str]:
    """Return for each component at which frequency something vibrates, if it does."""
    found = []
    for column in values.T:
        frequency, density = _density(column, period)
        fast = frequency > LOWEST_LINE
        strongest = int(np.argmax(density[fast]))
        seen = density[fast][strongest] > LINE * np.median(density[fast])
        found.append(f'{frequency[fast][strongest]:.1f}' if seen else 'none')
    return found


def _slope(axes: Axes, curves: Sequence[Allan], factor: float) -> None:
    """Draw the line of white noise beside the curves."""
    known = [curve.white_noise for curve in curves if curve.white_noise]
    if known:
        tau = next(curve.tau for curve in curves if len(curve.tau))[[0, -1]]
        axes.loglog(tau, np.median(known) * factor / np.sqrt(tau), color='#888888', lw=0.8,
                    ls='--', label='N/√τ')


def _legend(axes: Axes) -> None:
    if axes.lines:
        axes.legend(frameon=False, ncols=4, loc='lower right', bbox_to_anchor=(1.0, 0.98))


def _say_if_empty(axes: Axes) -> None:
    if not axes.lines:
        axes.text(0.5, 0.5, 'all values are the same', transform=axes.transAxes, ha='center')


def _pair() -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(WIDTH, 3.6), layout='constrained')
    axes = list(figure.subplots(1, 2))
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
    part = slice(rest.begin, min(rest.end, rest.begin + LONGEST))
    if part.stop - part.start < 2:
        return None
    seconds = signals.seconds[part]
    return part, float(seconds[-1] - seconds[0])


def _climbs(recording: Recording) -> Array:
    """Return for each inertial sample whether it is one of a climb or a descent."""
    # A steady one feels as being at rest does.
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
    values = [getattr(curve, name) for curve in curves]
    return ['not seen' if value is None else f'{value * factor:.3g}' for value in values]
