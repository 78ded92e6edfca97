# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the live page of a terminal, for 80 x 24 characters or more."""

from itertools import groupby, islice
import math
import time

from bahrs_driver.monitor.horizon import heading_tape, horizon, no_horizon
from bahrs_driver.monitor.tables import (
    has_topics, level_word, no_driver_hint, no_topics_hint, shared_name_hint,
)
from bahrs_driver.monitor.values import number
from bahrs_driver.monitor.watch import DATA_TIMEOUT, DRIVER_TIMEOUT, Watch
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import full_name, ROOT, USUAL_NAME
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Console, ConsoleOptions, RenderResult
from rich.layout import Layout
from rich.table import Table
from rich.text import Text

MIN_SIZE = 60, 16           # characters
_MARKS = {DiagnosticStatus.OK: '✓', DiagnosticStatus.WARN: '!', DiagnosticStatus.ERROR: '✗',
          DiagnosticStatus.STALE: '?'}
MAX_TASKS = 8              # that fit a page
MAX_SIGNALS = 64
MAX_INTEGRITY_LINES = 4
MAX_SIGNAL_LENGTH = 24         # characters
_GAP = '   '
_GOOD = 'green'             # style of a driver without a problem
_COMPONENTS = ('_x', '_y', '_z')
_ASCII = str.maketrans('✓✗░▄▀─·━╋ω°µ', '+x#_"--=+w*u')


class Page:
    """Draws the state of a watch, in the size of the terminal."""

    def __init__(self, watch: Watch) -> None:
        self._watch = watch

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the page."""
        width, height = console.size
        if width < MIN_SIZE[0] or height < MIN_SIZE[1]:
            yield Text(f'This terminal has {width}x{height} characters: make it '
                       f'{MIN_SIZE[0]}x{MIN_SIZE[1]} or more, 80x24 is good', 'yellow')
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
        title.append(f' {sentence}', '' if style == _GOOD else style)
        clock = time.strftime('%H:%M:%S UTC', time.gmtime())
        title.truncate(width - len(clock) - 1, overflow='ellipsis', pad=True)
        return title.append(f' {clock}', 'bold')

    def _state(self) -> tuple[str, str, str]:
        """Return the overall state as a word, a colour and a sentence."""
        watch = self._watch
        if not watch.driver_seen:
            return 'NO DRIVER', 'red', no_driver_hint(watch)
        if watch.health.age > DRIVER_TIMEOUT and watch.data_age > DATA_TIMEOUT:
            return 'DRIVER GONE', 'red', \
                f'nothing received for {_seconds(watch)}: {no_driver_hint(watch)}'
        if watch.health.shared_name:
            return 'TWO DRIVERS', 'red', shared_name_hint(watch)
        if watch.data_age > DATA_TIMEOUT:
            return 'NO DATA', 'red', self._why_no_data()
        if watch.health.age > DRIVER_TIMEOUT:
            return 'LIVE', _GOOD, 'no diagnostics are received'
        worst = max(watch.health.tasks.values(), key=lambda status: status.level)
        if worst.level == DiagnosticStatus.OK:
            return 'LIVE', _GOOD, self._device()
        return *level_word(worst.level), worst.message

    def _why_no_data(self) -> str:
        link = self._watch.health.tasks.get('Link')
        if link and link.level != DiagnosticStatus.OK:
            return link.message
        if not has_topics(self._watch):
            return no_topics_hint(self._watch)
        return f'the driver runs, but publishes no data for {_seconds(self._watch)}'

    def _device(self) -> str:
        tasks, driver = self._watch.health.tasks, self._watch.driver
        link, device = tasks.get('Link'), tasks.get('Device')
        values = link.values if link else {}
        version = device.values.get('Software version', '') if device else ''
        return ', '.join(filter(None, (
            driver if driver != full_name(USUAL_NAME, ROOT) else '',
            f"{values.get('Port', '')} at {values.get('Baud rate', '')} baud" if link else '',
            f"{values['Use of the line']} of the line in use"
            if 'Use of the line' in values else '',
            version)))

    def _attitude(self, width: int, height: int) -> Text:
        """Return heading tape, horizon and the figures of flight."""
        watch, angles = self._watch, self._watch.attitude()
        heading = watch.recent_message('heading')
        known = heading is not None and math.isfinite(heading.data)
        tape = heading_tape(heading.data, width) if known else \
            Text('no heading'.center(width), 'red')
        picture = no_horizon(width, height - 4, 'no attitude') if angles is None else \
            horizon(angles.roll, angles.pitch, width, height - 4)
        return Text('\n').join([
            tape, picture,
            _figures(width, ('roll', _signed(angles.roll, '°') if angles else '-'),
                     ('pitch', _signed(angles.pitch, '°') if angles else '-')),
            _figures(width, ('heading', number(heading.data, '.1f', '°') if known else '-'),
                     ('climb', self._climb())),
            _figures(width, ('height', self._height()))])

    def _height(self) -> str:
        for topic in ('pressure_altitude', 'fix'):
            message = self._watch.recent_message(topic)
            if message is not None:
                return number(message.altitude, '.1f', ' m')
        return '-'

    def _climb(self) -> str:
        message = self._watch.recent_message('velocity')
        if message is None:
            return '-'
        z = message.twist.twist.linear.z
        return _signed(-z if self._watch.z_down else z, ' m/s')

    def _topics(self) -> Table:
        table = Table(box=None, pad_edge=False, show_edge=False, expand=True)
        table.add_column('Topic', no_wrap=True)
        table.add_column('Hz', no_wrap=True, justify='right', width=6)
        table.add_column('Latest (SI)', no_wrap=True, ratio=1)
        for name, stats in self._watch.stats.items():
            if self._watch.is_published(name) or not self._watch.driver_seen:
                rate = stats.rate()
                style = '' if rate or stats.age < DATA_TIMEOUT else 'dim'
                table.add_row(name, f'{rate:.1f}' if stats.count else '-',
                              Text(self._watch.text(name), overflow='ellipsis'), style=style)
        return table

    def _integrity(self, width: int) -> list[Text]:
        """Return the lines with the integrity of each signal."""
        notice = self._watch.message('integrity')
        if notice is None:
            without = self._watch.driver_seen and not self._watch.is_published('integrity')
            text = 'this device reports no integrity' if without else 'no integrity received'
            return [Text(text, 'dim')]
        stale = self._watch.data_age > DATA_TIMEOUT
        lines = [Text()]
        signals = islice(notice.status, MAX_SIGNALS)
        for name, group in groupby(signals, key=lambda status: _quantity(status.name)):
            cell = Text(printable(name, MAX_SIGNAL_LENGTH), 'dim' if stale else '')
            for status in group:
                suffix = status.name[-1] if status.name.endswith(_COMPONENTS) else ''
                style = 'dim' if stale else level_word(status.level)[1]
                cell.append(f" {suffix}{_MARKS.get(status.level, '?')}", f'bold {style}')
            if len(lines[-1]) + len(cell) + len(_GAP) > width:
                if len(lines) == MAX_INTEGRITY_LINES:
                    break
                lines.append(Text())
            lines[-1].append_text(Text(_GAP) + cell if lines[-1] else cell)
        return lines

    def _tasks(self) -> Table:
        table = Table.grid(padding=(0, 1), expand=True)
        table.add_column(no_wrap=True, width=10)
        table.add_column(no_wrap=True, width=5)
        table.add_column(no_wrap=True, ratio=1, overflow='ellipsis')
        gone = self._watch.health.age > DRIVER_TIMEOUT
        for task, status in islice(self._watch.health.tasks.items(), MAX_TASKS):
            word, colour = level_word(status.level)
            table.add_row(Text(task), Text(word, '' if gone else colour), Text(status.message),
                          style='dim' if gone else '')
        if not self._watch.health.tasks:
            table.add_row('no driver', '', 'no diagnostics received yet')
        return table

    def _events(self) -> Text:
        """Return the latest changes of level, the latest first."""
        lines = [Text(time.strftime('%H:%M:%S ', time.gmtime(moment)), 'dim')
                 + Text(f'{task} ') + Text(*level_word(status.level))
                 + Text(f' {status.message}', 'dim')
                 for moment, task, status in self._watch.health.events]
        if lines:
            lines.insert(0, Text('Changes of level, the latest first', 'dim underline'))
        # A layout draws a placeholder box for an empty text.
        return Text('\n', no_wrap=True, overflow='ellipsis').join([Text(' '), *lines])


def _figures(width: int, *pairs: tuple[str, str]) -> Text:
    cell = width // len(pairs)
    line = Text()
    for name, value in pairs:
        line.append(f'{name} ', 'dim')
        line.append(value.ljust(cell - len(name) - 1), 'bold')
    return line


def _signed(value: float, unit: str) -> str:
    return number(round(value, 1) + 0.0, '+.1f', unit)          # never -0.0


def _quantity(signal: str) -> str:
    for suffix in _COMPONENTS:
        signal = signal.removesuffix(suffix)
    return signal.replace('_', ' ')


def _seconds(watch: Watch) -> str:
    age = min(watch.data_age, watch.health.age)
    return f'{age:.0f} s' if math.isfinite(age) else 'as long as this monitor runs'
