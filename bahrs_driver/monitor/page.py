# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Draw the live page of a terminal, for 80 x 24 characters or more."""

from itertools import groupby, islice
import math
import time

from bahrs_driver.monitor.hints import no_driver_hint, no_topics_hint, shared_name_hint
from bahrs_driver.monitor.horizon import heading_tape, horizon, no_horizon
from bahrs_driver.monitor.tables import level_word
from bahrs_driver.monitor.values import number_text
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
MAX_SHOWN_TASKS = 8         # that fit on the page
MAX_SIGNALS = 64
MAX_INTEGRITY_LINES = 4
MAX_SIGNAL_LENGTH = 24      # characters
_GAP = '   '
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
        tasks, topics, integrity = self._tasks(), self._topics(), self._integrity(width)
        task_rows = max(1, tasks.row_count)
        # Attitude and topics get the rows that title, integrity, tasks and two lines leave.
        rows = min(max(height - 3 - len(integrity) - task_rows, 6),
                   max(topics.row_count + 1, height // 2))
        left = min(31, width * 2 // 5) if width < 110 else min(2 * rows + 3, width * 2 // 5)
        left -= 1 - left % 2            # odd: the aircraft is in the middle
        upper = Layout(size=rows)
        upper.split_row(Layout(self._attitude(left, rows), size=left),
                        Layout(Text(' '), size=2), Layout(topics))
        line = Text('─' * width, 'dim')
        page = Layout()
        page.split_column(
            Layout(self._title(width), size=1), upper, Layout(line, size=1),
            Layout(Text('\n').join(integrity), size=len(integrity)), Layout(line, size=1),
            Layout(tasks, size=task_rows), Layout(self._events()))
        return page

    def _title(self, width: int) -> Text:
        colour, word, text = self._summary()
        title = Text(f' {word} ', f'bold reverse {colour}').append(f' {text}', colour)
        clock = time.strftime('%H:%M:%S UTC', time.gmtime())
        title.truncate(width - len(clock) - 1, overflow='ellipsis', pad=True)
        return title.append(f' {clock}', 'bold')

    def _summary(self) -> tuple[str, str, str]:
        """Return the state of driver and device as a colour, a word and a sentence."""
        watch = self._watch
        if not watch.driver_seen:
            return 'red', 'NO DRIVER', no_driver_hint(watch)
        if watch.health.age > DRIVER_TIMEOUT and watch.data_age > DATA_TIMEOUT:
            return 'red', 'DRIVER GONE', \
                f'nothing received {_since_when(watch)}: {no_driver_hint(watch)}'
        if watch.health.shared_name:
            return 'red', 'TWO DRIVERS', shared_name_hint(watch)
        if watch.data_age > DATA_TIMEOUT:
            return 'red', 'NO DATA', self._why_no_data()
        if watch.health.age > DRIVER_TIMEOUT:
            return 'green', 'LIVE', 'no diagnostics are received'
        worst = max(watch.health.tasks.values(), key=lambda status: status.level)
        if worst.level == DiagnosticStatus.OK:
            return 'green', 'LIVE', self._device()
        word, colour = level_word(worst.level)
        return colour, word, worst.message

    def _why_no_data(self) -> str:
        link = self._watch.health.tasks.get('Link')
        if link and link.level != DiagnosticStatus.OK:
            return link.message
        if not self._watch.has_topics:
            return no_topics_hint(self._watch)
        return f'the driver runs, but has published no data {_since_when(self._watch)}'

    def _device(self) -> str:
        tasks, driver = self._watch.health.tasks, self._watch.driver
        link, device = tasks.get('Link'), tasks.get('Device')
        parts = [driver] if driver != full_name(USUAL_NAME, ROOT) else []
        if link:
            values = link.values
            parts.append(f"{values.get('Port', '')} at {values.get('Baud rate', '')} baud")
            if 'Use of the line' in values:
                parts.append(f"{values['Use of the line']} of the line in use")
        if device and device.values.get('Software version'):
            parts.append(device.values['Software version'])
        return ', '.join(parts)

    def _attitude(self, width: int, height: int) -> Text:
        """Return heading tape, horizon, and the values as text."""
        watch, angles = self._watch, self._watch.attitude()
        heading = watch.recent_message('heading')
        known = heading is not None and math.isfinite(heading.data)
        tape = heading_tape(heading.data, width) if known else \
            Text('no heading'.center(width), 'red')
        picture = no_horizon(width, height - 4, 'no attitude') if angles is None else \
            horizon(angles.roll, angles.pitch, width, height - 4)
        roll, pitch = [_signed(angle, '°') for angle in angles[:2]] if angles else ['-', '-']
        heading_text = number_text(heading.data, '.1f', '°') if known else '-'
        return Text('\n').join([
            tape, picture,
            _named_values(width, ('roll', roll), ('pitch', pitch)),
            _named_values(width, ('heading', heading_text), ('climb', self._climb())),
            _named_values(width, ('height', self._height()))])

    def _height(self) -> str:
        for topic in ('pressure_altitude', 'fix'):
            message = self._watch.recent_message(topic)
            if message is not None:
                return number_text(message.altitude, '.1f', ' m')
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
        table.add_column('Latest (SI units)', no_wrap=True, ratio=1)
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
            absent = self._watch.driver_seen and not self._watch.is_published('integrity')
            text = 'this device reports no integrity' if absent else 'no integrity received'
            return [Text(text, 'dim')]
        stale = self._watch.data_age > DATA_TIMEOUT
        lines = [Text()]
        signals = islice(notice.status, MAX_SIGNALS)
        for name, components in groupby(signals, key=lambda status: _quantity(status.name)):
            cell = Text(printable(name, MAX_SIGNAL_LENGTH), 'dim' if stale else '')
            for status in components:
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
        for task, status in islice(self._watch.health.tasks.items(), MAX_SHOWN_TASKS):
            word, colour = level_word(status.level)
            table.add_row(Text(task), Text(word, '' if gone else colour), Text(status.message),
                          style='dim' if gone else '')
        if not self._watch.health.tasks:
            table.add_row('no tasks', '', 'no diagnostics received yet')
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


def _named_values(width: int, *pairs: tuple[str, str]) -> Text:
    cell = width // len(pairs)
    line = Text()
    for name, value in pairs:
        line.append(f'{name} ', 'dim')
        line.append(value.ljust(cell - len(name) - 1), 'bold')
    return line


def _signed(value: float, unit: str) -> str:
    return number_text(round(value, 1) + 0.0, '+.1f', unit)          # never -0.0


def _quantity(signal: str) -> str:
    """Return the name of a signal in words, without its component."""
    for suffix in _COMPONENTS:
        signal = signal.removesuffix(suffix)
    return signal.replace('_', ' ')


def _since_when(watch: Watch) -> str:
    age = min(watch.data_age, watch.health.age)
    return f'for {age:.0f} s' if math.isfinite(age) else 'since the monitor started'
