# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Write the tables of README and docs from the code that they describe."""

from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
import re
import sys

from bahrs_driver.devices.registry import all_topics, DEVICES, parameter_table
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.link_task import LinkTask
from bahrs_driver.diagnostics.publishing_task import PublishingTask
from bahrs_driver.diagnostics.task import DiagnosticTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.node.launch_arguments import ARGUMENTS
from bahrs_driver.ros_layout.layouts import LAYOUTS
from bahrs_driver.ros_layout.rows import HEADER, Row
from bahrs_driver.settings.parameter import Parameter
from bahrs_driver.tables.column import row_columns
from bahrs_driver.transport.link import Link

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / 'README.md'
PAGES = README, ROOT / 'docs' / 'tables.md'      # pages with generated tables
LEVELS = ('OK', 'WARN', 'ERROR', 'STALE')
# What stands in the messages of the table for each field.
EXAMPLES: dict[str, object] = {
    'access_command': 'sudo usermod -aG dialout you',
    'baud_rate': 115200,
    'command': '"fuser -v /dev/ttyUSB0"',
    'count': 3,
    'counts': '3 inertial, 1 navigation',
    'event': "the host's clock was set by +0.500000 s",
    'failures': 1,
    'fault': 'publishing inertial failed: OverflowError: too large',
    'found': [*DEVICES][-1],
    'gps': 'no fix',
    'hint': 'is the device powered, and is its line connected?',
    'holders': ' (minicom, process 4711)',
    'name': '/dev/ttyUSB0',
    'order': 'big',
    'port': '/dev/ttyUSB0',
    'problem': 'It is week 2300 by gps.week and week 2417 by the clock of the host, which is '
               'used: correct gps.week, or leave it 0',
    'programs': 'cat, process 4711',
    'rates': 'inertial at 180 Hz instead of 200',
    'rate_remedy': 'lower state.rate, gps.rate or sensors.rate',
    'reason': 'it belongs to group dialout',
    'remedy': 'join the group and log in again',
    'sensor': 'bahrs',
    'server': 'socket://host:4001',
    'share': 0.3,
    'signals': 'magnetic_heading unavailable, roll integrity risk',
    'signals_at_risk': 'roll integrity risk',
    'skipped': 24,
    'user': 'you',
    'why_lost': 'the other end of the connection has not answered for 5 s, check its power and '
                'the network',
    'write_error': '/dev/ttyUSB0 does not take data: it has accepted nothing for 1 s',
}


def diagnostics_table() -> str:
    """Return the messages of all diagnostic tasks as a Markdown table."""
    rows = ['| what is wrong | task | level | message |', '|---|---|---|---|']
    rows += [f'| {message.cause} | {task.name} | {LEVELS[ord(message.level)]} '
             f'| {message.text.format(**EXAMPLES)} |'
             for task in _tasks() for message in task.messages if message.cause]
    return '\n'.join(rows)


def _tasks() -> Iterable[type[DiagnosticTask]]:
    """Return the tasks of all devices, each class once."""
    tasks: list[type[DiagnosticTask]] = [LinkTask, FramingTask, TimeTask]
    for spec in DEVICES.values():
        parts = spec.parts(spec.settings())
        tasks += map(type, [*parts.health.tasks, *parts.live(Link('/dev/null', 115200)).tasks])
    return dict.fromkeys([*tasks, PublishingTask])


def parameters_table() -> str:
    """Return the parameters as a Markdown table."""
    rows = ['| parameter | default | valid | what it is |', '|---|---|---|---|']
    rows += [f'| `{parameter.name}` | {_default(parameter)} | {_valid(parameter)} '
             f'| {parameter.description} |' for parameter in parameter_table()]
    return '\n'.join(rows)


def launch_table() -> str:
    """Return the arguments of the launch files as a Markdown table."""
    rows = ['| argument | valid | what it is |', '|---|---|---|']
    rows += [f'| `{row.name}` | {row.valid} | {row.description} |' for row in ARGUMENTS]
    return '\n'.join(rows)


def columns_table() -> str:
    """Return the columns of the tables of all topics, and their units, as a Markdown table."""
    topics = defaultdict(list)
    for topic, kind in all_topics().items():
        topics[kind].append(f'`{topic}`')
    rows = ['| topics | columns beside time and header | unit |', '|---|---|---|']
    for kind, names in topics.items():
        shown = ', '.join(names)
        for row in LAYOUTS[kind].rows:
            if row not in HEADER:
                rows.append(f'| {shown} | {_columns(row)} | {_units(row)} |')
                shown = ''
    return '\n'.join(rows)


def _columns(row: Row) -> str:
    first, *others = [column.name for column in row_columns(row)]
    if len(others) > len('xyzw'):
        return f"`{first}` to `.{others[-1].rpartition('.')[2]}`"
    return ', '.join([f'`{first}`', *(f"`.{name.rpartition('.')[2]}`" for name in others)])


def _units(row: Row) -> str:
    return ', '.join(dict.fromkeys(column.unit for column in row_columns(row)))


def with_tables(text: str) -> str:
    """Return a page with its tables generated again."""
    tables = {'parameters': parameters_table, 'diagnostics': diagnostics_table,
              'launch': launch_table, 'columns': columns_table}
    pattern = re.compile(rf'(<!-- ({"|".join(tables)}) -->\n).*?(<!-- end -->)', re.DOTALL)
    return pattern.sub(lambda match: match[1] + tables[match[2]]() + '\n' + match[3], text)


def missing_topics(text: str) -> list[str]:
    """Return the topics that the README does not name with their type."""
    return [topic for topic, kind in all_topics().items()
            if not re.search(rf'\| `{topic}` \| \w+/{kind.__name__} \|', text)]


def _default(parameter: Parameter) -> str:
    if isinstance(parameter.default, bool):
        return str(parameter.default).lower()
    unit = parameter.unit and ' ' + parameter.unit
    other = parameter.other_default
    return f'`{parameter.default}`{unit}' + (f', `{other.default}`' if other else '')


def _valid(parameter: Parameter) -> str:
    if parameter.choices:
        return ', '.join(f'`{choice}`' for choice in parameter.choices)
    if parameter.low is not None:
        return f'{"0, " if parameter.or_zero else ""}{parameter.low} to {parameter.high}'
    return 'true or false' if isinstance(parameter.default, bool) else 'any text'


def main() -> int:
    """Write the pages; 1 if the README lacks a topic."""
    for page in PAGES:
        page.write_text(with_tables(page.read_text()))
    missing = missing_topics(README.read_text())
    if missing:
        print(f'the README lacks: {", ".join(missing)}', file=sys.stderr)
    return bool(missing)


if __name__ == '__main__':
    sys.exit(main())
