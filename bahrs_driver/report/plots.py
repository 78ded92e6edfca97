# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw a recording over time."""

import math

from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.clock import ClockAnalysis
from bahrs_driver.report.decimate import angle_envelope, envelope, runs
from bahrs_driver.report.gather import Recording, Signals
from bahrs_driver.report.time_axis import Array
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator
import numpy as np

WIDTH = 11.4            # inches, at 100 pixels each
LEFT, RIGHT, TOP, BOTTOM = 1.35, 0.25, 0.3, 0.5     # inches around the panels
COLOURS = ('#1f77b4', '#d62728', '#2ca02c')
BANDS = {Integrity.SAFE: '#8bc98b', Integrity.INTEGRITY_RISK: '#f2b134',
         Integrity.UNAVAILABLE: '#d9534f', Integrity.RESERVED: '#7d3c98'}
LONG = 7200             # s, above which times have hours
NARROWEST_BAND = 0.002  # of the whole time: a short loss of a signal stays visible
MOST_BANDS = 2000       # of a signal; with more, each pixel shows the worst state
_INERTIAL = (('specific_force', 'm/s²', 1.0), ('angular_rate', '°/s', math.degrees(1)))
_BY_BADNESS = np.array([Integrity.SAFE, Integrity.INTEGRITY_RISK, Integrity.RESERVED,
                        Integrity.UNAVAILABLE])


def integrity_bands(recording: Recording) -> Figure:
    """Draw the integrity of each signal, and gaps without data."""
    rows = [(name, signals, index) for signals in (recording.inertial, recording.navigation)
            for index, name in enumerate(signals.names)]
    figure, (axes,) = _figure(1, 0.25 * len(rows) + TOP + BOTTOM)
    for row, (name, signals, index) in enumerate(rows):
        _band(axes, row, signals.seconds, signals.health[:, index])
    axes.set_yticks(range(len(rows)), [name.replace('_', ' ') for name, *_ in rows])
    axes.set_ylim(len(rows) - 0.45, -0.55)
    axes.grid(False)
    axes.tick_params(axis='y', length=0)
    seen = {int(state) for _, signals, index in rows
            for state in np.unique(signals.health[:, index])}
    axes.legend(handles=[Patch(color=BANDS[state], label=state.words)
                         for state in BANDS if state in seen or state is Integrity.SAFE],
                loc='lower right', bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False)
    _time_axis(axes, recording.duration)
    return figure


def inertial(recording: Recording) -> Figure:
    """Draw specific force and angular rate, one panel for each component."""
    figure, panels = _figure(6, 7.4)
    signals = recording.inertial
    for index, axes in enumerate(panels):
        name, unit, factor = _INERTIAL[index // 3]
        values = signals.values[name][:, index % 3] * factor
        bad = np.isin(signals.health[:, index], (Integrity.UNAVAILABLE, Integrity.RESERVED))
        _draw(axes, signals.seconds, np.where(bad, np.nan, values), COLOURS[index % 3],
              signals.names[index].replace('_', ' '))
        axes.set_ylabel(f'{"xyz"[index % 3]} [{unit}]')
        axes.yaxis.set_major_locator(MaxNLocator(4))
    for axes, title in ((panels[0], 'specific force'), (panels[3], 'angular rate')):
        axes.set_title(title, loc='left', fontsize=10, fontweight='bold')
    _time_axis(panels[-1], recording.duration)
    return figure


def attitude(recording: Recording) -> Figure:
    """Draw roll, pitch and heading."""
    figure, (level, heading) = _figure(2, 4.6)
    signals = recording.navigation
    _line(level, signals, 'roll', 2, COLOURS[0], math.degrees(1))
    _line(level, signals, 'pitch', 3, COLOURS[1], math.degrees(1))
    level.set_ylabel('roll, pitch [°]')
    _legend(level)
    values = _available(signals, 'magnetic_heading', 4) * math.degrees(1)
    if np.isnan(values).all():
        _never(heading, 'the magnetic heading was never available')
    else:
        heading.plot(*angle_envelope(signals.seconds, values % 360.0), color=COLOURS[2], lw=0.9)
    heading.set_ylim(0, 360)
    heading.set_yticks(range(0, 361, 90), ['N', 'E', 'S', 'W', 'N'])
    heading.set_ylabel('heading [°]')
    _time_axis(heading, recording.duration)
    return figure


def height(recording: Recording) -> Figure:
    """Draw pressure height and vertical velocity, positive upward."""
    figure, (above, below) = _figure(2, 4.2)
    signals = recording.navigation
    _line(above, signals, 'pressure_height', 0, COLOURS[0], 1.0)
    above.set_ylabel('pressure height [m]')
    _line(below, signals, 'velocity_down', 1, COLOURS[1], -1.0)
    below.set_ylabel('climb [m/s]')
    _time_axis(below, recording.duration)
    return figure


def accuracy(recording: Recording) -> Figure:
    """Draw the standard deviations that the device reports for its attitude."""
    figure, (axes,) = _figure(1, 2.6)
    signals = recording.accuracy
    # The first two are often the same: the one below is drawn broader.
    for colour, wide, name, label in zip(
            ('#9ecae9', *COLOURS[1:]), (4.0, 1.1, 1.1), ('north_std', 'east_std', 'heading_std'),
            ('about north', 'about east', 'heading')):
        values = signals.values[name] * math.degrees(1)
        if not np.isnan(values).all():
            axes.plot(*envelope(signals.seconds, values), color=colour, lw=wide, label=label)
    axes.set_ylabel('1σ [°]')
    axes.set_ylim(bottom=0.0)
    if axes.lines:
        _legend(axes)
    else:
        _never(axes, 'the device never sent an accuracy')
    _time_axis(axes, recording.duration)
    return figure


def flow(recording: Recording) -> Figure:
    """Draw the rates of messages, and the rates at which a device sends."""
    figure, (axes,) = _figure(1, 2.3)
    for colour, signals, label, nominal in (
            (COLOURS[0], recording.inertial, 'inertial', 200),
            (COLOURS[1], recording.navigation, 'navigation', 100)):
        width = max(1.0, recording.duration / 1000)
        edges = np.arange(0.0, max(recording.duration, width), width)
        counts, _ = np.histogram(signals.seconds, np.append(edges, edges[-1] + width))
        whole = edges + width <= recording.duration
        axes.plot(*_steps(edges[whole], counts[whole] / width, width), color=colour, lw=1.1,
                  label=label)
        axes.axhline(nominal, color=colour, lw=0.8, ls=':')
    axes.set_ylim(0, 230)
    axes.set_yticks(range(0, 201, 50))
    axes.set_ylabel('messages\na second')
    _legend(axes)
    _time_axis(axes, recording.duration)
    return figure


def arrivals(analysis: ClockAnalysis, duration: float) -> Figure:
    """Draw the delays of samples above the smallest, without drift."""
    figure, (axes,) = _figure(1, 2.6)
    axes.plot(*envelope(analysis.seconds, analysis.delay * 1e3), color=COLOURS[0], lw=0.7)
    axes.set_ylabel('delay [ms]')
    axes.set_ylim(bottom=0.0)
    _time_axis(axes, duration)
    return figure


def _figure(rows: int, tall: float) -> tuple[Figure, list[Axes]]:
    """Return panels below each other, with the same time axis in all figures."""
    figure = Figure(figsize=(WIDTH, tall))
    axes = figure.subplots(rows, 1, sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(left=LEFT / WIDTH, right=1 - RIGHT / WIDTH, top=1 - TOP / tall,
                           bottom=BOTTOM / tall, hspace=0.34)
    for each in axes:
        each.grid(True, color='#dddddd', lw=0.6)
        each.set_axisbelow(True)
        each.spines[['top', 'right']].set_visible(False)
        each.yaxis.set_major_locator(MaxNLocator(6))
        each.yaxis.set_label_coords(-0.72 / (WIDTH - LEFT - RIGHT), 0.5)
    return figure, list(axes)


def _time_axis(axes: Axes, duration: float) -> None:
    axes.set_xlim(0, duration or 1.0)
    if duration > 120:
        step = next((step for step in (15, 30, 60, 120, 300, 600, 1200, 1800, 3600)
                     if duration / step <= 14), 7200)
        axes.set_xticks(np.arange(0, duration, step))
        # In minutes and seconds, or in hours and minutes.
        unit, name = (3600, 'h:min') if duration > LONG else (60, 'min:s')
        axes.xaxis.set_major_formatter(FuncFormatter(
            lambda value, _: f'{int(value) // unit}:{int(value) % unit * 60 // unit:02d}'))
        axes.set_xlabel(f'time since the first sample [{name}]')
    else:
        axes.set_xlabel('time since the first sample [s]')


def _available(signals: Signals, name: str, index: int) -> Array:
    values = signals.values[name].astype(float)
    health = signals.health[:, index]
    values[(health == Integrity.UNAVAILABLE) | (health == Integrity.RESERVED)] = np.nan
    return values


def _line(axes: Axes, signals: Signals, name: str, index: int, colour: str,
          factor: float) -> None:
    _draw(axes, signals.seconds, _available(signals, name, index) * factor, colour,
          name.replace('_', ' '))


def _draw(axes: Axes, seconds: Array, values: Array, colour: str, label: str) -> None:
    if np.isnan(values).all():
        _never(axes, f'the {label} was never available')
    else:
        axes.plot(*envelope(seconds, values), color=colour, lw=0.9, label=label)


def _legend(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc='lower right', bbox_to_anchor=(1.0, 0.99), ncols=4, frameon=False,
                    borderaxespad=0.1)


def _never(axes: Axes, sentence: str) -> None:
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha='center', va='center',
              color='#a33', fontsize=11)


def _steps(edges: Array, values: Array, width: float) -> tuple[Array, Array]:
    return np.repeat(np.append(edges, edges[-1:] + width), 2)[1:-1], np.repeat(values, 2)


def _band(axes: Axes, row: int, seconds: Array, states: Array) -> None:
    """Draw one signal: a bar for each interval of a state, white for gaps."""
    if not len(seconds):
        return
    if 1 + np.count_nonzero(np.diff(states)) > MOST_BANDS:
        seconds, states = _worst(seconds, states)
    gaps = np.flatnonzero(np.diff(seconds) > max(0.5, 0.002 * seconds[-1])) + 1
    pieces = [interval for piece, held in zip(np.split(seconds, gaps), np.split(states, gaps))
              for interval in runs(piece, held)]
    for state in BANDS:             # safe first: the other states are drawn over it
        narrowest = 0.0 if state is Integrity.SAFE else NARROWEST_BAND * float(seconds[-1])
        bars = [(begin, max(end - begin, narrowest)) for begin, end, held in pieces
                if held == state]
        axes.broken_barh(bars, (row - 0.4, 0.8), facecolors=BANDS[state], linewidth=0)


def _worst(seconds: Array, states: Array) -> tuple[Array, Array]:
    """Return fewer points, each with the worst state of its bucket."""
    starts = np.linspace(0, len(seconds), MOST_BANDS, endpoint=False).astype(np.int64)
    worst = np.maximum.reduceat(np.argsort(_BY_BADNESS)[states], starts)
    return seconds[starts], _BY_BADNESS[worst]
