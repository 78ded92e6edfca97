# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the noise of a device at rest: specific force on the left, angular rate on the right."""

from collections.abc import Sequence
import math

from bahrs_driver.report.allan import AllanDeviation
from bahrs_driver.report.noise import COMPONENTS, DEG_PER_H, RestNoise
from bahrs_driver.report.plots import COLOURS, draw_legend, style_panel, WIDTH
from bahrs_driver.report.spectrum import amplitude_density
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

MAX_SHADED_ERROR = 0.9      # relative; a logarithmic axis has no 0
_GREY = '#888888'


def spectrum(noise: RestNoise) -> Figure:
    """Draw the spectral density, with the Nyquist frequency dotted."""
    figure, panels = _force_and_rate_panels()
    for axes, values, unit in ((panels[0], noise.force, 'm/s²'),
                               (panels[1], noise.rate * math.degrees(1), '°/s')):
        for colour, name, column in zip(COLOURS, COMPONENTS, values.T):
            frequency, density = amplitude_density(column, noise.period)
            if density.any():
                axes.loglog(frequency, density, color=colour, lw=0.8, label=name)
        if axes.lines:
            axes.axvline(0.5 / noise.period, color=_GREY, lw=0.8, ls=':')
        low, high = axes.get_ylim()
        axes.set_ylim(low / 2, high * 2)
        _finish(axes, f'{unit}/√Hz', 'frequency [Hz]')
    return figure


def deviation(noise: RestNoise) -> Figure:
    """Draw the Allan deviation, shaded by its uncertainty and thick where it is reliable."""
    figure, panels = _force_and_rate_panels()
    for axes, curves, factor, unit in ((panels[0], noise.force_allan, 1.0, 'm/s²'),
                                       (panels[1], noise.rate_allan, DEG_PER_H, '°/h')):
        for colour, name, curve in zip(COLOURS, COMPONENTS, curves):
            if not len(curve.tau):
                continue
            value, reliable = curve.deviation * factor, curve.reliable
            axes.loglog(curve.tau[reliable], value[reliable], color=colour, lw=1.4, label=name)
            axes.loglog(curve.tau, value, color=colour, lw=0.5)
            error = np.minimum(curve.relative_error, MAX_SHADED_ERROR)
            axes.fill_between(curve.tau, value * (1 - error), value * (1 + error), color=colour,
                              alpha=0.15, lw=0)
        _draw_white_noise(axes, curves, factor)
        _finish(axes, unit, 'averaging time τ [s]')
    return figure


def _draw_white_noise(axes: Axes, curves: Sequence[AllanDeviation], factor: float) -> None:
    """Draw the slope of white noise beside the curves."""
    known = [curve.white_noise.value for curve in curves if curve.white_noise.value]
    if known:
        tau = next(curve.tau for curve in curves if len(curve.tau))[[0, -1]]
        axes.loglog(tau, np.median(known) * factor / np.sqrt(tau), color=_GREY, lw=0.8, ls='--',
                    label='N/√τ')


def _force_and_rate_panels() -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(WIDTH, 3.6), layout='constrained')
    panels: list[Axes] = figure.subplots(1, 2, squeeze=False)[0].tolist()
    for axes, quantity in zip(panels, ('specific force', 'angular rate')):
        style_panel(axes)
        axes.set_title(quantity, loc='left', fontsize=10, fontweight='bold')
    return figure, panels


def _finish(axes: Axes, unit: str, x_label: str) -> None:
    """Label the axes, and say why there is no curve if there is none."""
    if not axes.lines:
        axes.text(0.5, 0.5, 'all values are the same', transform=axes.transAxes, ha='center')
    axes.set_ylabel(f'[{unit}]')
    axes.set_xlabel(x_label)
    draw_legend(axes)
