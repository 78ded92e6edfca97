# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Show the state of a watch as plain tables or JSON values, and hints for the user."""

import os

from bahrs_driver.monitor.watch import Watch
from bahrs_driver.process.printable import printable
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Group
from rich.table import Table
from rich.text import Text

LEVELS = {DiagnosticStatus.OK: ('OK', 'green'), DiagnosticStatus.WARN: ('WARN', 'yellow'),
          DiagnosticStatus.ERROR: ('ERROR', 'red'), DiagnosticStatus.STALE: ('STALE', 'blue')}


def level_word(level: bytes) -> tuple[str, str]:
    """Return a word and a colour for a level, also for an undefined one."""
    return LEVELS.get(level) or (f'LEVEL {level[0]}' if level else 'LEVEL ?', 'magenta')


def no_driver_hint(watch: Watch) -> str:
    """Return what to check if no driver was seen."""
    domain = printable(os.environ.get('ROS_DOMAIN_ID') or '0')
    selection = watch.choice.selection
    which = f' with the {selection}' if any(selection) else ''
    return f'is driver_node running{which}, and is ROS_DOMAIN_ID ({domain} here) the same?'


def no_topics_hint(watch: Watch) -> str:
    """Return what to check if a driver was seen, but none of its topics."""
    return f'{watch.driver} publishes none of its topics in {printable(watch.namespace)}: are ' \
           f'they remapped? See "ros2 node info {watch.driver}"'


def shared_name_hint(watch: Watch) -> str:
    """Return the remedy for two drivers of the same name."""
    return f'two drivers are named {watch.driver}: start one with -r __node:=NAME, or in a ' \
           'namespace'


def has_topics(watch: Watch) -> bool:
    """Return whether any topic of the driver is published."""
    return any(watch.is_published(name) for name in watch.stats)


def tables(watch: Watch) -> Group:
    """Return the present state."""
    topics = Table('Topic', 'Hz', 'Count', 'Latest (SI)', box=None, pad_edge=False)
    for name, stats in watch.stats.items():
        if watch.driver_seen and not watch.is_published(name):
            continue            # of another device
        topics.add_row(name, f'{stats.rate():.1f}', f'{stats.count:,}', Text(watch.text(name)))
    health = Table('Task', 'Level', 'Message', box=None, pad_edge=False)
    for task, status in watch.health.tasks.items():
        health.add_row(Text(task), Text(*level_word(status.level)), Text(status.message))
    if not watch.driver_seen:
        health.add_row('no driver', '', Text(no_driver_hint(watch)))
    elif watch.health.shared_name:
        health.add_row('', '', Text(shared_name_hint(watch)))
    elif not has_topics(watch):
        health.add_row('', '', Text(no_topics_hint(watch)))
    title = Text(f'{watch.driver}\n', 'bold') if watch.driver_seen and watch.driver else Text()
    return Group(*([title] if title else []), topics, '', health)


def to_json(watch: Watch) -> dict[str, object]:
    """Return the present state as plain JSON values."""
    return {
        'heard': watch.driver_seen,
        'node': watch.driver,
        'topics': {name: {'rate': round(stats.rate(), 2), 'count': stats.count,
                          'latest': watch.text(name)}
                   for name, stats in watch.stats.items()},
        'diagnostics': {task: {'level': level_word(status.level)[0], 'message': status.message,
                               'values': dict(status.values)}
                        for task, status in watch.health.tasks.items()}}
