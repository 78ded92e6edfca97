# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw a recording over time."""

import math

from bahrs_driver.protocol.batch import Array
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.clock import ClockAnalysis
from bahrs_driver.report.decimate import angle_envelope, envelope
from bahrs_driver.report.gather import Recording, Signals
from bahrs_driver.report.integrity import find_intervals, MAX_STEP
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator
import numpy as np

WIDTH = 11.4            # inches, at 100 pixels each
LEFT, RIGHT, TOP, BOTTOM = 1.35, 0.25, 0.3, 0.5     # inches around the panels
COLOURS = ('#1f77b4', '#d62728', '#2ca02c')
# Safe first: the other states are drawn over it.
BAND_COLOURS = {Integrity.SAFE: '#8bc98b', Integrity.INTEGRITY_RISK: '#f2b134',
                Integrity.RESERVED: '#7d3c98', Integrity.UNAVAILABLE: '#d9534f'}
MAX_CHANGES = 2000      # of a signal's integrity; with more, each pixel shows the worst state
MIN_BAND = 0.002        # of the whole time: a short loss of a signal stays visible
MIN_GAP = 0.002         # of the whole time, drawn as a gap
HOURS_FROM = 7200       # s, above which times have hours
TICK_STEPS = (15, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200)        # s
MAX_TICKS = 14
_BY_SEVERITY = np.array(list(BAND_COLOURS))


def integrity_bands(recording: Recording) -> Figure:
    """Draw the integrity of each signal, and gaps without data."""
    rows = [(name, signals.seconds, signals.health[:, column])
            for signals in (recording.inertial, recording.navigation)
            for column, name in enumerate(signals.names)]
    figure, (axes,) = _figure(1, 0.25 * len(rows) + TOP + BOTTOM)
    for row, (_, seconds, states) in enumerate(rows):
        _draw_band(axes, row, seconds, states)
    axes.set_yticks(range(len(rows)), [name.replace('_', ' ') for name, *_ in rows])
    axes.set_ylim(len(rows) - 0.45, -0.55)
    axes.grid(False)
    axes.tick_params(axis='y', length=0)
    shown = {Integrity.SAFE}.union(*(np.unique(states).tolist() for _, _, states in rows))
    axes.legend(handles=[Patch(color=colour, label=state.words)
                         for state, colour in BAND_COLOURS.items() if state in shown],
                loc='lower right', bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False)
    _label_time(axes, recording.duration)
    return figure


def inertial(recording: Recording) -> Figure:
    """Draw specific force and angular rate, one panel for each component."""
    figure, panels = _figure(6, 7.4)
    signals = recording.inertial
    for field, unit, factor, own_panels in (
            ('specific_force', 'm/s²', 1.0, panels[:3]),
            ('angular_rate', '°/s', math.degrees(1), panels[3:])):
        quantity = field.replace('_', ' ')
        own_panels[0].set_title(quantity, loc='left', fontsize=10, fontweight='bold')
        for axes, name, colour, values in zip(
                own_panels, 'xyz', COLOURS, signals.available(field).T):
            _draw(axes, signals.seconds, values * factor, colour, f'{quantity} {name}')
            axes.set_ylabel(f'{name} [{unit}]')
            axes.yaxis.set_major_locator(MaxNLocator(4))
    _label_time(panels[-1], recording.duration)
    return figure


def attitude(recording: Recording) -> Figure:
    """Draw roll, pitch and heading."""
    figure, (upper, lower) = _figure(2, 4.6)
    signals = recording.navigation
    _draw_field(upper, signals, 'roll', COLOURS[0], math.degrees(1))
    _draw_field(upper, signals, 'pitch', COLOURS[1], math.degrees(1))
    upper.set_ylabel('roll, pitch [°]')
    draw_legend(upper)
    heading = signals.available('magnetic_heading') * math.degrees(1)
    if np.isnan(heading).all():
        _draw_missing(lower, 'the magnetic heading was never available')
    else:
        lower.plot(*angle_envelope(signals.seconds, heading % 360.0), color=COLOURS[2], lw=0.9)
    lower.set_ylim(0, 360)
    lower.set_yticks(range(0, 361, 90), ['N', 'E', 'S', 'W', 'N'])
    lower.set_ylabel('heading [°]')
    _label_time(lower, recording.duration)
    return figure


def height(recording: Recording) -> Figure:
    """Draw pressure height and vertical velocity, positive upward."""
    figure, (upper, lower) = _figure(2, 4.2)
    _draw_field(upper, recording.navigation, 'pressure_height', COLOURS[0])
    upper.set_ylabel('pressure height [m]')
    _draw_field(lower, recording.navigation, 'velocity_down', COLOURS[1], -1.0)
    lower.set_ylabel('climb [m/s]')
    _label_time(lower, recording.duration)
    return figure


def accuracy(recording: Recording) -> Figure:
    """Draw the standard deviations that the device reports for its attitude."""
    figure, (axes,) = _figure(1, 2.6)
    signals = recording.accuracy
    # The first two are often the same: the one below is drawn broader.
    for field, label, colour, width in (('north_std', 'about north', '#9ecae9', 4.0),
                                        ('east_std', 'about east', COLOURS[1], 1.1),
                                        ('heading_std', 'heading', COLOURS[2], 1.1)):
        values = signals.values[field] * math.degrees(1)
        if not np.isnan(values).all():
            axes.plot(*envelope(signals.seconds, values), color=colour, lw=width, label=label)
    axes.set_ylabel('1σ [°]')
    axes.set_ylim(bottom=0.0)
    draw_legend(axes)
    if not axes.lines:
        _draw_missing(axes, 'the device never sent an accuracy')
    _label_time(axes, recording.duration)
    return figure


def data_rate(recording: Recording) -> Figure:
    """Draw the rates of messages, and the rates at which a device sends."""
    figure, (axes,) = _figure(1, 2.3)
    width = max(1.0, recording.duration / 1000)
    edges = np.arange(0.0, max(recording.duration, width) + width, width)
    whole = edges[1:] <= recording.duration
    for signals, colour, label in ((recording.inertial, COLOURS[0], 'inertial'),
                                   (recording.navigation, COLOURS[1], 'navigation')):
        counts, _ = np.histogram(signals.seconds, edges)
        axes.stairs(counts[whole] / width, edges[:1 + np.count_nonzero(whole)], color=colour,
                    lw=1.1, label=label, baseline=None)
        axes.axhline(signals.rate, color=colour, lw=0.8, ls=':')
    axes.set_ylim(0, 1.15 * recording.inertial.rate)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.set_ylabel('messages\nper second')
    draw_legend(axes)
    _label_time(axes, recording.duration)
    return figure


def delays(analysis: ClockAnalysis, duration: float) -> Figure:
    """Draw the delays of samples above the smallest, without drift."""
    figure, (axes,) = _figure(1, 2.6)
    axes.plot(*envelope(analysis.seconds, analysis.delay * 1e3), color=COLOURS[0], lw=0.7)
    axes.set_ylabel('delay [ms]')
    axes.set_ylim(bottom=0.0)
    _label_time(axes, duration)
    return figure


def style_panel(axes: Axes) -> None:
    """Draw a grid, and remove the frame at the top and on the right."""
    axes.grid(True, color='#dddddd', lw=0.6)
    axes.spines[['top', 'right']].set_visible(False)


def draw_legend(axes: Axes) -> None:
    """Draw the legend above the panel on the right, if there are curves."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc='lower right', bbox_to_anchor=(1.0, 0.99), ncols=4, frameon=False,
                    borderaxespad=0.1)


def _figure(rows: int, height_inches: float) -> tuple[Figure, list[Axes]]:
    """Return panels below each other; the time axis is at the same place in all figures."""
    figure = Figure(figsize=(WIDTH, height_inches))
    panels: list[Axes] = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0].tolist()
    figure.subplots_adjust(left=LEFT / WIDTH, right=1 - RIGHT / WIDTH, hspace=0.34,
                           top=1 - TOP / height_inches, bottom=BOTTOM / height_inches)
    for axes in panels:
        style_panel(axes)
        axes.set_axisbelow(True)
        axes.yaxis.set_major_locator(MaxNLocator(6))
        axes.yaxis.set_label_coords(-0.72 / (WIDTH - LEFT - RIGHT), 0.5)
    return figure, panels


def _label_time(axes: Axes, duration: float) -> None:
    axes.set_xlim(0, duration or 1.0)
    unit = 's'
    if duration > 120:
        step = next((step for step in TICK_STEPS if duration / step <= MAX_TICKS), TICK_STEPS[-1])
        axes.set_xticks(np.arange(0, duration, step))
        major, unit = (3600, 'h:min') if duration > HOURS_FROM else (60, 'min:s')
        axes.xaxis.set_major_formatter(FuncFormatter(
            lambda value, _: f'{int(value) // major}:{int(value) % major * 60 // major:02d}'))
    axes.set_xlabel(f'time since the first sample [{unit}]')


def _draw_field(axes: Axes, signals: Signals, field: str, colour: str,
                factor: float = 1.0) -> None:
    _draw(axes, signals.seconds, signals.available(field) * factor, colour,
          field.replace('_', ' '))


def _draw(axes: Axes, seconds: Array, values: Array, colour: str, label: str) -> None:
    if np.isnan(values).all():
        _draw_missing(axes, f'the {label} was never available')
    else:
        axes.plot(*envelope(seconds, values), color=colour, lw=0.9, label=label)


def _draw_missing(axes: Axes, reason: str) -> None:
    axes.text(0.5, 0.5, reason, transform=axes.transAxes, ha='center', va='center',
              color='#a33', fontsize=11)


def _draw_band(axes: Axes, row: int, seconds: Array, states: Array) -> None:
    """Draw one signal: a bar for each interval of a state, white for gaps."""
    if not len(seconds):
        return
    if np.count_nonzero(np.diff(states)) > MAX_CHANGES:
        seconds, states = _worst_states(seconds, states)
    for state, colour in BAND_COLOURS.items():
        shortest = 0.0 if state is Integrity.SAFE else MIN_BAND * seconds[-1]
        bars = [(begin, max(length, shortest)) for begin, length in find_intervals(
            seconds, states == state, max(MAX_STEP, MIN_GAP * seconds[-1]))]
        axes.broken_barh(bars, (row - 0.4, 0.8), facecolors=colour, linewidth=0)


def _worst_states(seconds: Array, states: Array) -> tuple[Array, Array]:
    """Return MAX_CHANGES points, each with the worst state of its share of the samples."""
    starts = np.linspace(0, len(seconds), MAX_CHANGES, endpoint=False).astype(np.int64)
    worst = np.maximum.reduceat(np.argsort(_BY_SEVERITY)[states], starts)
    return seconds[starts], _BY_SEVERITY[worst]
