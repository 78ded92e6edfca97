# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The live page of a terminal: 80 x 24 characters are enough, and more are made use of."""

from itertools import groupby
import math
import time

from bahrs_driver.monitor.horizon import heading_tape, horizon, no_horizon
from bahrs_driver.monitor.tables import LEVELS, nobody
from bahrs_driver.monitor.watch import DATA_TIMEOUT, DRIVER_TIMEOUT, Watch
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Console, ConsoleOptions, RenderResult
from rich.layout import Layout
from rich.table import Table
from rich.text import Text

SMALLEST = 60, 16           # characters; less is told to be too small
_MARKS = {DiagnosticStatus.OK: '✓', DiagnosticStatus.WARN: '!', DiagnosticStatus.ERROR: '✗',
          DiagnosticStatus.STALE: '?'}
_GAP = '   '
_COMPONENTS = ('_x', '_y', '_z')
_ASCII = str.maketrans('✓✗░▄▀─·━╋ω°µ', '+x#_"--=+w*u')


class Page:
    """Draws what a watch has heard, to the size that there is."""

    def __init__(self, watch: Watch) -> None:
        """Take the watch."""
        self._watch = watch

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the page."""
        width, height = console.size
        if width < SMALLEST[0] or height < SMALLEST[1]:
            yield Text(f'This terminal has {width}x{height} characters: make it '
                       f'{SMALLEST[0]}x{SMALLEST[1]} or more, 80x24 is good', 'yellow')
            return
        for segment in console.render(self._layout(width, height), options):
            yield segment._replace(text=segment.text.translate(_ASCII)) \
                if options.ascii_only else segment

    def _layout(self, width: int, height: int) -> Layout:
        tasks, topics = self._tasks(), self._topics()
        integrity = self._integrity(width)
        below = 1 + len(integrity) + 1 + max(1, tasks.row_count)
        above = min(max(height - 1 - below, 6), max(topics.row_count + 1, height // 2))
        left = min(31, width * 2 // 5) if width < 110 else min(2 * above + 3, width * 2 // 5)
        left -= 1 - left % 2
        middle, page, body = Layout(name='middle', size=above), Layout(), []
        middle.split_row(Layout(self._attitude(left, above), size=left),
                         Layout(Text(' '), size=2), Layout(topics))
        body = [Layout(self._title(width), size=1), middle,
                Layout(Text('─' * width, 'dim'), size=1),
                Layout(Text('\n').join(integrity), size=len(integrity)),
                Layout(Text('─' * width, 'dim'), size=1),
                Layout(tasks, size=max(1, tasks.row_count))]
        body.append(Layout(self._events()))
        page.split_column(*body)
        return page

    def _title(self, width: int) -> Text:
        word, style, sentence = self._state()
        title = Text(f' {word} ', f'bold reverse {style}')
        title.append(f' {sentence}', style if word != 'LIVE' else '')
        clock = time.strftime('%H:%M:%S UTC', time.gmtime())
        title.truncate(width - len(clock) - 1, overflow='ellipsis', pad=True)
        return title.append(f' {clock}', 'bold')

    def _state(self) -> tuple[str, str, str]:
        """Return in a word, a colour and a sentence how things are as a whole."""
        watch = self._watch
        if not watch.heard:
            return 'NO DRIVER', 'red', nobody()
        if watch.health_age > DRIVER_TIMEOUT and watch.data_age > DATA_TIMEOUT:
            return 'DRIVER GONE', 'red', f'nothing heard for {_seconds(watch)}: {nobody()}'
        if watch.data_age > DATA_TIMEOUT:
            return 'NO DATA', 'red', self._why_no_data()
        if watch.health_age > DRIVER_TIMEOUT:
            return 'LIVE', 'green', 'no diagnostics are heard'
        worst = max(watch.health.values(), key=lambda status: ord(status.level))
        if worst.level == DiagnosticStatus.OK:
            return 'LIVE', 'green', self._device()
        word, colour = LEVELS[worst.level]
        return word, colour, str(worst.message)

    def _why_no_data(self) -> str:
        link = self._watch.health.get('Link')
        if link and link.level != DiagnosticStatus.OK:
            return str(link.message)
        return f'the driver runs, but publishes no data for {_seconds(self._watch)}'

    def _device(self) -> str:
        link, device = self._watch.values('Link'), self._watch.health.get('Device')
        version = device.message if device and ':' not in device.message else ''
        return ', '.join(filter(None, (
            f"{link.get('Port', '')} at {link.get('Baud rate', '')} baud" if link else '',
            f"{link['Use of the line']} of the line in use" if 'Use of the line' in link else '',
            version)))

    def _attitude(self, width: int, height: int) -> Text:
        """Return heading tape, horizon and the figures of flight."""
        watch, angles = self._watch, self._watch.attitude()
        heading = watch.fresh('heading')
        known = heading is not None and not math.isnan(heading.data)
        tape = heading_tape(heading.data, width) if known else \
            Text('no heading'.center(width), 'red')
        picture = no_horizon(width, height - 4, 'no attitude') if angles is None else \
            horizon(angles.roll, angles.pitch, width, height - 4)
        return Text('\n').join([
            tape, picture,
            _figures(width, ('roll', f'{_signed(angles.roll)}°' if angles else '-'),
                     ('pitch', f'{_signed(angles.pitch)}°' if angles else '-')),
            _figures(width, ('heading', f'{heading.data:.1f}°' if known else '-'),
                     ('climb', self._climb())),
            _figures(width, ('height', self._height()))])

    def _height(self) -> str:
        for topic in ('pressure_altitude', 'fix'):
            message = self._watch.fresh(topic)
            if message is not None:
                return f'{message.altitude:.1f} m'
        return '-'

    def _climb(self) -> str:
        message = self._watch.fresh('velocity')
        if message is None:
            return '-'
        z = message.twist.twist.linear.z
        return f'{_signed(-z if self._watch.z_down else z)} m/s'

    def _topics(self) -> Table:
        table = Table(box=None, pad_edge=False, show_edge=False, expand=True)
        table.add_column('Topic', no_wrap=True)
        table.add_column('Hz', no_wrap=True, justify='right', width=6)
        table.add_column('Latest (SI)', no_wrap=True, ratio=1)
        for name, tally in self._watch.tallies.items():
            if self._watch.offered(name) or not self._watch.heard:
                rate = tally.rate()
                style = '' if rate or tally.age < DATA_TIMEOUT else 'dim'
                table.add_row(name, f'{rate:.1f}' if tally.count else '-',
                              Text(self._watch.text(name), overflow='ellipsis'), style=style)
        return table

    def _integrity(self, width: int) -> list[Text]:
        """Return the lines that tell of each signal what it is worth."""
        notice = self._watch.message('integrity')
        if notice is None:
            without = self._watch.heard and not self._watch.offered('integrity')
            return [Text('this device tells no integrity' if without else 'no integrity heard',
                         'dim')]
        stale = self._watch.data_age > DATA_TIMEOUT
        lines = [Text()]
        for name, group in groupby(notice.status, key=lambda status: _quantity(status.name)):
            cell = Text(name, 'dim' if stale else '')
            for status in group:
                suffix = status.name[-1] if status.name.endswith(_COMPONENTS) else ''
                style = 'dim' if stale else LEVELS[status.level][1]
                cell.append(f' {suffix}{_MARKS[status.level]}', f'bold {style}')
            if len(lines[-1]) + len(cell) + len(_GAP) > width:
                lines.append(Text())
            lines[-1].append_text(Text(_GAP) + cell if lines[-1] else cell)
        return lines

    def _tasks(self) -> Table:
        table = Table.grid(padding=(0, 1), expand=True)
        table.add_column(no_wrap=True, width=10)
        table.add_column(no_wrap=True, width=5)
        table.add_column(no_wrap=True, ratio=1, overflow='ellipsis')
        gone = self._watch.health_age > DRIVER_TIMEOUT
        for task, status in self._watch.health.items():
            word, colour = LEVELS[status.level]
            table.add_row(task, Text(word, '' if gone else colour), Text(status.message),
                          style='dim' if gone else '')
        if not self._watch.health:
            table.add_row('no driver', '', 'no diagnostics heard yet')
        return table

    def _events(self) -> Text:
        """Return what changed lately, the latest first."""
        lines = [Text(time.strftime('%H:%M:%S ', time.gmtime(moment)), 'dim')
                 + Text(f'{task} ') + Text(LEVELS[status.level][0], LEVELS[status.level][1])
                 + Text(f' {status.message}', 'dim')
                 for moment, task, status in self._watch.events]
        if lines:
            lines.insert(0, Text('Changes of level, the latest first', 'dim underline'))
        # A layout takes an empty text for none, and draws a box that says so.
        return Text('\n', no_wrap=True, overflow='ellipsis').join([Text(' '), *lines])


def _figures(width: int, *pairs: tuple[str, str]) -> Text:
    cell = width // len(pairs)
    line = Text()
    for name, value in pairs:
        line.append(f'{name} ', 'dim')
        line.append(value.ljust(cell - len(name) - 1), 'bold')
    return line


def _signed(value: float) -> str:
    return f'{round(value, 1) + 0.0:+.1f}'          # never -0.0


def _quantity(signal: str) -> str:
    for suffix in _COMPONENTS:
        signal = signal.removesuffix(suffix)
    return signal.replace('_', ' ')


def _seconds(watch: Watch) -> str:
    age = min(watch.data_age, watch.health_age)
    return f'{age:.0f} s' if math.isfinite(age) else 'as long as this listens'
