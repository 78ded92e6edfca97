# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write a self-contained HTML page, which needs no network."""

import base64
from collections.abc import Callable, Iterable, Iterator
from html import escape
import io
import time

from bahrs_driver.process.printable import printable
from bahrs_driver.report import noise_plots, plots
from bahrs_driver.report.clock import analyze_clock, ClockAnalysis
from bahrs_driver.report.finding import time_text
from bahrs_driver.report.findings import findings
from bahrs_driver.report.gather import Recording
from bahrs_driver.report.noise import analyze_noise, MIN_REST, remarks, table_rows
from bahrs_driver.report.rest import find_rest
from bahrs_driver.units import NS_PER_S
import matplotlib
from matplotlib.figure import Figure

_STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; color: #222; background: #fff;
       max-width: 1180px; margin: 24px auto; padding: 0 24px; }
h1 { font-size: 26px; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 19px; margin: 34px 0 4px; }
p { margin: 4px 0 8px; max-width: 80em; }
.lead { color: #555; margin-bottom: 18px; }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(210px, 1fr)); gap: 10px; }
.fact { background: #f4f6f8; border-radius: 8px; padding: 8px 12px; }
.fact b { display: block; font-size: 18px; overflow-wrap: anywhere; }
.fact b.long { font-size: 14px; line-height: 1.9; } .fact span { color: #555; font-size: 13px; }
ul { list-style: none; padding: 0; margin: 6px 0; }
li { padding: 5px 12px; margin: 4px 0; border-left: 6px solid; border-radius: 4px;
     background: #f7f7f7; }
.error { border-color: #c0392b; } .warning { border-color: #e69f00; }
.notice { border-color: #3b82c4; } .good { border-color: #4caf50; }
li b { display: inline-block; width: 5em; }
img { width: 100%; height: auto; display: block; }
table { border-collapse: collapse; margin: 10px 0; }
td, th { padding: 3px 16px 3px 0; border-bottom: 1px solid #ddd; text-align: left; }
td + td, th + th { text-align: right; font-variant-numeric: tabular-nums; }
footer { color: #777; font-size: 13px; margin: 40px 0 20px; }
@media print { h2, img, li { break-inside: avoid; } }
"""
_LONG = ' class="long"'
MAX_LARGE_FONT = 16     # characters of a value; a longer one is set in a smaller font
MAX_TEXT = 2000         # characters of a sentence
_MATPLOTLIB = {'svg.fonttype': 'path', 'svg.hashsalt': 'bahrs', 'font.size': 10,
               'path.simplify': True, 'axes.unicode_minus': True}
# Title, caption and figure of each section about the samples.
_SECTIONS: tuple[tuple[str, str, Callable[[Recording], Figure]], ...] = (
    ('Integrity', 'Integrity reported by the device. White: no data.', plots.integrity_bands),
    ('Data rate', 'Messages per second. Dotted: the nominal rate.', plots.data_rate),
    ('Specific force and angular rate',
     'In body axes: forward, right, down. At rest the specific force is about -9.8 m/s² along z. '
     'Where samples are closer than pixels, the smallest and largest values are drawn.',
     plots.inertial),
    ('Attitude and heading',
     'Positive roll is to the right, positive pitch nose up; the heading is magnetic, clockwise '
     'from north.', plots.attitude),
    ('Height and vertical speed',
     'Height above the 1013.25 hPa level of the standard atmosphere; climb is positive up.',
     plots.height),
    ('Accuracy',
     'Standard deviations of the attitude that the device reports: rotations about north and '
     'east, and the heading, if it has one.', plots.accuracy))
_DELAYS = ('Delay of each sample above the smallest, without the drift between the clocks of '
           "device and host. A smooth band comes from an adapter's timer, peaks from a busy host. "
           'The driver removes these delays from its stamps.')
_NO_READ_TIMES = (
    'The recording has no times of reads, so offset, drift and delays are unknown. A bag with the '
    'topic <code>raw</code> has them: start the driver with the parameter '
    '<code>publish.raw</code>, and run <code>bahrs record</code>.')
_SPECTRUM = ('Spectral density. White noise is flat; peaks are vibrations or rotating parts. '
             'Dotted: half the sample rate.')
_ALLAN = ('Overlapping Allan deviation (IEEE Std 952), shaded by one standard error. N (white '
          'noise) is read where the slope is -1/2, K (random walk) where it is +1/2, each over a '
          'decade of τ, and B (bias instability) at the lowest point. Only the thick part of a '
          'curve is read: its standard error is at most 25 %, and it ends at a ninth of the rest.')


def page(recording: Recording) -> Iterator[str]:
    """Yield the page in parts."""
    analysis = analyze_clock(recording)
    yield '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
    yield '<meta name="viewport" content="width=device-width, initial-scale=1">'
    name = _text(recording.name)
    yield f'<title>{name}</title><style>{_STYLE}</style></head><body>\n'
    yield f'<h1>{name}</h1><p class="lead">{_text(_lead(recording))}</p>\n'
    yield '<div class="facts">' + ''.join(
        f'<div class="fact"><span>{_text(label)}</span>'
        f'<b{_LONG if len(value) > MAX_LARGE_FONT else ""}>{_text(value)}</b></div>'
        for label, value in _facts(recording, analysis)) + '</div>\n'
    yield '<h2>Findings</h2><ul>' + ''.join(
        f'<li class="{severity.value}"><b>{severity.value}</b>{_text(text)}</li>'
        for severity, text in findings(recording, analysis)) + '</ul>\n'
    with matplotlib.rc_context(_MATPLOTLIB):
        if len(recording.inertial.seconds) or len(recording.navigation.seconds):
            for title, caption, draw in _SECTIONS:
                yield _section(title, caption, draw(recording))
        yield from _clock(recording, analysis)
        yield from _noise(recording)
    yield '<footer>Made by <code>bahrs report</code>. Axes are those of the device: forward, '
    yield 'right, down.</footer></body></html>\n'


def _clock(recording: Recording, analysis: ClockAnalysis | None) -> Iterator[str]:
    yield '<h2>Clock</h2>'
    yield _table(_clock_rows(recording, analysis))
    if analysis is None:
        yield f'<p>{_NO_READ_TIMES}</p>'
    else:
        yield f'<p>{_text(_DELAYS)}</p>'
        yield _image(plots.delays(analysis, recording.duration), 'delays')


def _noise(recording: Recording) -> Iterator[str]:
    rest = find_rest(recording)
    if rest.seconds < MIN_REST:
        yield ('<h2>Noise at rest</h2><p>Noise can be separated from motion only at rest: the '
               f'longest rest of the device is {rest.seconds:.0f} s, and {MIN_REST:.0f} s are '
               'needed.</p>')
        return
    noise = analyze_noise(recording, rest)
    yield _section(f'Noise at rest, {noise.seconds:.0f} s from {time_text(noise.begin)}',
                   _SPECTRUM, noise_plots.spectrum(noise))
    yield f'<p>{_text(_ALLAN)}</p>' + _image(noise_plots.deviation(noise), 'Allan deviation')
    yield _table([('', ['x', 'y', 'z']), *table_rows(noise)])
    yield ''.join(f'<p>{_text(remark)}</p>' for remark in remarks(noise))


def _lead(recording: Recording) -> str:
    versions = ' and '.join(str(version) for version in sorted(recording.versions)) or '-'
    reads = recording.reads
    start = f', read from {_date(reads.ros_ns[0] / NS_PER_S)} on' if reads else ''
    return f'{recording.size:,} bytes of a {recording.device}, protocol version {versions}{start}.'


def _date(seconds: float) -> str:
    return time.strftime('%Y-%m-%d %H:%M:%S UTC', time.gmtime(seconds))


def _facts(recording: Recording, analysis: ClockAnalysis | None) -> Iterator[tuple[str, str]]:
    software, hardware = recording.software, recording.hardware
    minutes, tenths = divmod(round(recording.duration * 10), 600)
    yield 'duration', f'{minutes} min {tenths / 10} s' if minutes else f'{tenths / 10} s'
    yield 'software', f'{software.project} {software.major}.{software.minor}' \
        if software else 'not received'
    if hardware:
        yield 'unique number', ''.join(f'{word:08X}' for word in hardware.unique_id)
    for name, signals in (('inertial', recording.inertial), ('navigation', recording.navigation)):
        yield f'{name} messages', f'{len(signals.seconds):,}'
    lost = sum(gap.missing for gap in recording.time_axis.breaks)
    yield 'inertial samples lost', f'{lost:,}'
    yield 'damaged frames', f'{recording.counters.crc_failures:,}'
    yield 'accuracy messages', f"{recording.counts.get('accuracy', 0):,}"
    yield 'CRC order', recording.crc_order or 'not seen'
    if len(recording.pulses):
        yield 'sync pulses', f'{len(recording.pulses):,}'
    if analysis and analysis.drift_ppm is not None:
        yield 'clock drift', f'{analysis.drift_ppm:+.1f} ppm'


def _clock_rows(recording: Recording,
                analysis: ClockAnalysis | None) -> Iterator[tuple[str, list[str]]]:
    axis = recording.time_axis
    labels = {None: '-', 0: 'the sample just sent', 1: 'the next sample'}
    yield 'time messages name', [labels.get(axis.label_ahead, f'{axis.label_ahead} ahead')]
    yield 'time messages used', [f'{axis.anchors:,}']
    yield 'time messages rejected', [f'{axis.rejected:,}']
    if axis.period is not None:
        yield "sample period on the device's clock", [f'{axis.period * 1e6:.3f} µs']
    if analysis is None:
        return
    yield "drift: the device's clock is fast by", [
        'recording too short' if analysis.drift_ppm is None else f'{analysis.drift_ppm:+.2f} ppm']
    yield 'device time was 0 at', [_date(analysis.device_zero)]
    yield 'delay that 99 of 100 samples do not exceed', [f'{analysis.delay_99 * 1e3:.2f} ms']
    yield 'bytes per read (median)', [f'{analysis.read_bytes}']
    yield 'longest time between two reads', [f'{analysis.longest_pause * 1e3:.1f} ms']
    yield "host's clock set", [f'{analysis.host_steps} times']


def _text(text: str) -> str:
    """Escape a text, which may come from the recording, for HTML."""
    return escape(printable(text, MAX_TEXT))


def _section(title: str, caption: str, figure: Figure) -> str:
    return f'<h2>{_text(title)}</h2><p>{_text(caption)}</p>{_image(figure, title)}\n'


def _image(figure: Figure, title: str) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format='svg', metadata={'Date': None})
    data = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{_text(title)}" src="data:image/svg+xml;base64,{data}">\n'


def _table(rows: Iterable[tuple[str, list[str]]]) -> str:
    lines = [''.join(f'<td>{_text(cell)}</td>' for cell in (name, *cells))
             for name, cells in rows]
    return '<table>' + ''.join(f'<tr>{line}</tr>' for line in lines) + '</table>\n'
