# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Everything in plain lines, for pipes, files, and the end of a live page."""

import os
from typing import Any

from bahrs_driver.monitor.watch import Watch
from bahrs_driver.process.printable import printable
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Group
from rich.table import Table
from rich.text import Text

LEVELS = {DiagnosticStatus.OK: ('OK', 'green'), DiagnosticStatus.WARN: ('WARN', 'yellow'),
          DiagnosticStatus.ERROR: ('ERROR', 'red'), DiagnosticStatus.STALE: ('STALE', 'blue')}


def level_word(level: bytes) -> tuple[str, str]:
    """Return a word and a colour for a level, also for one that no driver should use."""
    return LEVELS.get(level) or (f'LEVEL {level[0]}' if level else 'LEVEL ?', 'magenta')


def no_driver_hint(watch: Watch) -> str:
    """Return what to look at when no driver is heard."""
    domain = printable(os.environ.get('ROS_DOMAIN_ID') or '0')
    selection = watch.choice.selection
    which = f' with the {selection}' if any(selection) else ''
    return f'is driver_node running{which}, and is ROS_DOMAIN_ID ({domain} here) the same?'


def no_topics_hint(watch: Watch) -> str:
    """Return what to look at when a driver is heard, but none of its topics is there."""
    return f'{watch.driver} publishes none of its topics in {printable(watch.namespace)}: are ' \
           f'they remapped? See "ros2 node info {watch.driver}"'


def shared_name_hint(watch: Watch) -> str:
    """Return what to do about two drivers of the same name."""
    return f'two drivers are named {watch.driver}: start one with -r __node:=NAME, or in a ' \
           'namespace'


def has_topics(watch: Watch) -> bool:
    """Return whether any topic of the driver is there."""
    return any(watch.offered(name) for name in watch.tallies)


def tables(watch: Watch) -> Group:
    """Return the present state."""
    topics = Table('Topic', 'Hz', 'Count', 'Latest (SI)', box=None, pad_edge=False)
    for name, tally in watch.tallies.items():
        if watch.heard and not watch.offered(name):
            continue            # of another device
        topics.add_row(name, f'{tally.rate():.1f}', f'{tally.count:,}', Text(watch.text(name)))
    health = Table('Task', 'Level', 'Message', box=None, pad_edge=False)
    for task, status in watch.health.tasks.items():
        health.add_row(Text(task), Text(*level_word(status.level)), Text(status.message))
    if not watch.heard:
        health.add_row('no driver heard', '', Text(no_driver_hint(watch)))
    elif watch.health.shared_name:
        health.add_row('', '', Text(shared_name_hint(watch)))
    elif not has_topics(watch):
        health.add_row('', '', Text(no_topics_hint(watch)))
    title = Text(f'{watch.driver}\n', 'bold') if watch.heard and watch.driver else Text()
    return Group(*([title] if title else []), topics, '', health)


def record(watch: Watch) -> dict[str, Any]:
    """Return the present state as plain JSON values."""
    return {
        'heard': watch.heard,
        'node': watch.driver,
        'topics': {name: {'rate': round(tally.rate(), 2), 'count': tally.count,
                          'latest': watch.text(name)}
                   for name, tally in watch.tallies.items()},
        'diagnostics': {task: {'level': level_word(status.level)[0], 'message': status.message,
                               'values': dict(status.values)}
                        for task, status in watch.health.tasks.items()}}
