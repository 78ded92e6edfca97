# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Everything in plain lines, for pipes, files, and the end of a live page."""

import os
from typing import Any

from bahrs_driver.monitor.watch import Watch
from diagnostic_msgs.msg import DiagnosticStatus
from rich.console import Group
from rich.table import Table
from rich.text import Text

LEVELS = {DiagnosticStatus.OK: ('OK', 'green'), DiagnosticStatus.WARN: ('WARN', 'yellow'),
          DiagnosticStatus.ERROR: ('ERROR', 'red'), DiagnosticStatus.STALE: ('STALE', 'blue')}


def nobody() -> str:
    """Return what to look at when no driver is heard."""
    domain = os.environ.get('ROS_DOMAIN_ID') or '0'
    return f'is driver_node running, and is ROS_DOMAIN_ID ({domain} here) the same?'


def tables(watch: Watch) -> Group:
    """Return the present state."""
    topics = Table('Topic', 'Hz', 'Count', 'Latest (SI)', box=None, pad_edge=False)
    for name, tally in watch.tallies.items():
        if watch.heard and not watch.offered(name):
            continue            # of another device
        topics.add_row(name, f'{tally.rate():.1f}', f'{tally.count:,}', Text(watch.text(name)))
    health = Table('Task', 'Level', 'Message', box=None, pad_edge=False)
    for task, status in watch.health.items():
        word, colour = LEVELS[status.level]
        health.add_row(task, f'[{colour}]{word}[/]', Text(status.message))
    if not watch.heard:
        health.add_row('no driver heard', '', nobody())
    return Group(topics, '', health)


def record(watch: Watch) -> dict[str, Any]:
    """Return the present state as plain JSON values."""
    return {
        'heard': watch.heard,
        'topics': {name: {'rate': round(tally.rate(), 2), 'count': tally.count,
                          'latest': watch.text(name)}
                   for name, tally in watch.tallies.items()},
        'diagnostics': {task: {'level': LEVELS[status.level][0], 'message': status.message,
                               'values': dict(watch.values(task))}
                        for task, status in watch.health.items()}}
