# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Show the state of a watch as plain tables or JSON values."""

from bahrs_driver.monitor.hints import discovery_hint
from bahrs_driver.monitor.watch import Watch
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Group
from rich.table import Table
from rich.text import Text

LEVELS = {DiagnosticStatus.OK: ('OK', 'green'), DiagnosticStatus.WARN: ('WARN', 'yellow'),
          DiagnosticStatus.ERROR: ('ERROR', 'red'), DiagnosticStatus.STALE: ('STALE', 'blue')}


def level_word(level: bytes) -> tuple[str, str]:
    """Return a word and a colour for a level, which may be an undefined one."""
    return LEVELS.get(level) or (f'LEVEL {level[0]}' if level else 'LEVEL ?', 'magenta')


def tables(watch: Watch) -> Group:
    """Return tables of topics and tasks, and what to check if they are not found."""
    topics = Table('Topic', 'Hz', 'Count', 'Latest (SI units)', box=None, pad_edge=False)
    for name, stats in watch.stats.items():
        if watch.driver_seen and not watch.is_published(name):
            continue            # of another device
        topics.add_row(name, f'{stats.rate():.1f}', f'{stats.count:,}', Text(watch.text(name)))
    health = Table('Task', 'Level', 'Message', box=None, pad_edge=False)
    for task, status in watch.health.tasks.items():
        health.add_row(Text(task), Text(*level_word(status.level)), Text(status.message))
    if hint := discovery_hint(watch):
        health.add_row('' if watch.driver_seen else 'no driver', '', Text(hint))
    title = Text(f'{watch.driver}\n', 'bold') if watch.driver_seen and watch.driver else Text()
    return Group(*([title] if title else []), topics, '', health)


def to_json(watch: Watch) -> dict[str, object]:
    """Return the state as plain JSON values."""
    return {
        'heard': watch.driver_seen,
        'node': watch.driver,
        'topics': {name: {'rate': round(stats.rate(), 2), 'count': stats.count,
                          'latest': watch.text(name)}
                   for name, stats in watch.stats.items()},
        'diagnostics': {task: {'level': level_word(status.level)[0], 'message': status.message,
                               'values': dict(status.values)}
                        for task, status in watch.health.tasks.items()}}
