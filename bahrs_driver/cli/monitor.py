# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs monitor`: show the topics of the driver, live."""

import argparse
import json
import math
import os
import time

from bahrs_driver.cli.node_options import add_node_options, selected_node, several_nodes
from bahrs_driver.cli.ros_session import ros_session
from bahrs_driver.cli.signals import shutdown_on_signal
from bahrs_driver.errors import CommandError
from bahrs_driver.monitor.hints import no_driver_hint
from bahrs_driver.monitor.page import Page
from bahrs_driver.monitor.tables import tables, to_json
from bahrs_driver.monitor.watch import Watch
from bahrs_driver.process.shutdown_event import ShutdownEvent
from bahrs_driver.ros.start_errors import start_errors
from diagnostic_msgs.msg import DiagnosticStatus
import rclpy
from rich.console import Console
from rich.live import Live

REFRESH = 0.25              # s
FIRST_DATA = 5.0            # s after which data should have arrived

EXIT_STATUS = '0, or 1 if no driver was found (with --require-data: no data)'
_EXAMPLES = """examples:
  bahrs monitor                             a live page, until Ctrl-C
  bahrs monitor --duration 15               then print a table
  bahrs monitor --duration 5 --json         for a script
  bahrs monitor --node /left/bahrs_driver   one of several drivers
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Show attitude, heading, height, rates, integrity and diagnostics of the driver on a\n'
        'live page of 80x24 characters or more. Roll to the right and pitch upward are positive\n'
        'in every frame_convention. The last state is printed as a table at the end, or if the\n'
        'output is not a terminal.')
    parser.epilog = _EXAMPLES
    parser.add_argument('--duration', type=float, metavar='SECONDS',
                        help='end after this time (default: at Ctrl-C)')
    add_node_options(parser)
    parser.add_argument('--require-data', action='store_true',
                        help='exit with status 1 and the reason if no data arrives')
    parser.add_argument('--json', action='store_true',
                        help='print the last state as one JSON object, without a page')


def run(options: argparse.Namespace) -> int:
    """Watch until the duration is over or Ctrl-C; 1 if no driver was found."""
    selection = selected_node(options)
    console = Console()
    begin = time.monotonic()
    end = math.inf if options.duration is None else begin + options.duration
    with shutdown_on_signal() as shutdown, ros_session(options) as keep:
        with start_errors(options.ros_arguments):
            watch = Watch(keep(rclpy.create_node(f'bahrs_monitor_{os.getpid()}')), selection)
        if console.is_terminal and not options.json:
            _show(watch, console, end, shutdown)
        else:
            _watch(watch, end, shutdown)
    if options.json:
        print(json.dumps(to_json(watch)))
    else:
        console.print(tables(watch))
    listened = time.monotonic() >= min(end, begin + FIRST_DATA)     # not with an early Ctrl-C
    if options.require_data and listened and not watch.data_received:
        raise CommandError(f'no data arrived: {_why_no_data(watch)}')
    return 0 if watch.driver_seen else 1


def _why_no_data(watch: Watch) -> str:
    problems = [status.message for status in watch.health.tasks.values()
                if status.level == DiagnosticStatus.ERROR]
    if problems:
        return problems[0]
    return 'the driver runs and reports no error' if watch.driver_seen else no_driver_hint(watch)


def _show(watch: Watch, console: Console, end: float, shutdown: ShutdownEvent) -> None:
    with Live(Page(watch), console=console, screen=True, auto_refresh=False) as live:
        while time.monotonic() < end and not shutdown.is_set():
            _spin(watch, end)
            live.refresh()


def _watch(watch: Watch, end: float, shutdown: ShutdownEvent) -> None:
    while time.monotonic() < end and not shutdown.is_set():
        _spin(watch, end)


def _spin(watch: Watch, end: float) -> None:
    watch.spin(min(REFRESH, end - time.monotonic()))
    if watch.choice.several:
        raise several_nodes(watch.choice.several)
