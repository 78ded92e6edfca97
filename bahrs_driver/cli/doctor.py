# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs doctor`: diagnose missing data, and print the command that fixes it."""

import argparse
from collections.abc import Iterator
import contextlib
from functools import partial
from importlib.util import find_spec
import json
import os
from pathlib import Path
import sys

from bahrs_driver.doctor import listening, ros_environment, usb_port
from bahrs_driver.doctor.check_result import CheckResult, Level, Prevents, problem
from bahrs_driver.doctor.commands import run_driver
from bahrs_driver.errors import CommandError, RosStartError
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.start import check_import
from bahrs_driver.transport.machine import Machine
from rich.console import Console
from rich.text import Text

DEFAULT_PORT = '/dev/ttyUSB0'
LONGEST_LINE = 2000     # characters of a message or command
_STYLES = {Level.OK: 'green', Level.ADVICE: 'yellow', Level.PROBLEM: 'bold red'}
EXIT_STATUS = '0 if there is no problem, 1 if there is one; advice does not count'
_EXAMPLES = """examples:
  bahrs doctor                                  check the only USB adapter
  bahrs doctor /dev/ttyUSB1 --json              for a script
  bahrs doctor --ask                            also find a device that only answers
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Check the port, its adapter and the programs that use it, the device and its baud rate,\n'
        'the set-up of ROS, running drivers and their subscribers. Below each problem stands the\n'
        'command that fixes it. Nothing is sent to the device without --ask.')
    parser.epilog = _EXAMPLES
    parser.add_argument('port_given', nargs='?', metavar='PORT',
                        help='path or URL (default: the only USB adapter, or '
                             f'{DEFAULT_PORT})')
    parser.add_argument('--port', help='the same as PORT')
    parser.add_argument('--baud-rate', type=int, default=115200, metavar='BAUD',
                        help='rate to try first (default: %(default)s)')
    parser.add_argument('--namespace', metavar='NAME',
                        help='check only drivers in this namespace (default: any)')
    parser.add_argument('--no-listen', action='store_true',
                        help='do not open the port')
    parser.add_argument('--ask', action='store_true',
                        help='send requests, for a device that only answers')
    parser.add_argument('--json', action='store_true',
                        help='print one JSON array of check, level, message and command')
    parser.add_argument('--root', type=Path, default=Path('/'), help=argparse.SUPPRESS)


def run(options: argparse.Namespace) -> int:
    """Run all checks; 1 if there is a problem."""
    has_rclpy = _has_rclpy()
    options.port = _one_port(options)
    if 'rclpy' in sys.modules:
        from bahrs_driver.cli.node_options import selected_namespace  # needs ROS
        options.namespace = selected_namespace(options)
    results = []
    console = Console(soft_wrap=True, highlight=False)
    for result in _results(options, has_rclpy):
        results.append(result)
        if not options.json:
            _show(console, result)
    if options.json:
        print(json.dumps([result.to_json() for result in results], indent=2))
    return int(any(result.level is Level.PROBLEM for result in results))


def _results(options: argparse.Namespace, has_rclpy: bool) -> Iterator[CheckResult]:
    machine = Machine(options.root)
    port = options.port or _usual_port(machine)
    is_path = '://' not in port
    if is_path:
        port = os.path.abspath(port)
    may_listen, probed = not options.no_listen, None
    for result in usb_port.check_port(machine, port, _rule()) if is_path else ():
        yield result
        may_listen &= result.prevents is not Prevents.LISTENING
    if may_listen:
        probed = yield from listening.check(str(machine.path(port)) if is_path else port,
                                            options.baud_rate, ask=options.ask)
    # All following commands are for the device that was recognized.
    make_command = partial(run_driver, sensor=probed.sensor, baud_rate=probed.baud_rate) \
        if probed else partial(run_driver, baud_rate=options.baud_rate)
    if is_path:
        yield from usb_port.check_name(machine, port, _rule(), make_command)
    ros_works = True
    for result in ros_environment.check(machine.environment, has_rclpy, Path(sys.prefix)):
        yield result
        ros_works &= result.prevents is not Prevents.ROS
    if ros_works:
        yield from _graph(options, port, make_command(port))


def _has_rclpy() -> bool:
    # Before any output: rclpy from PyPI may restart Python to set up its libraries.
    try:
        check_import()
        import rclpy  # noqa: F401
    except ImportError:
        return False
    except RosStartError:
        return find_spec('rclpy') is not None       # importing it would end the process
    return True


def _graph(options: argparse.Namespace, port: str, command: str) -> Iterator[CheckResult]:
    from bahrs_driver.cli.ros_session import ros_session  # needs ROS, the doctor must run without
    from bahrs_driver.doctor import graph
    from bahrs_driver.ros.start_errors import start_errors
    import rclpy
    try:
        with ros_session(options) as keep:
            with start_errors(options.ros_arguments):
                node = keep(rclpy.create_node(f'bahrs_doctor_{os.getpid()}',
                                              namespace=options.namespace))
            yield from graph.check(node, port, command=command, namespace=options.namespace)
    except RosStartError as error:
        yield problem('start', str(error), 'printenv | grep -E "^(ROS|RMW|RCUTILS|FASTDDS)"')


def _one_port(options: argparse.Namespace) -> str | None:
    if options.port and options.port_given and options.port != options.port_given:
        raise CommandError(f'{options.port_given!r} and --port {options.port!r} are two ports: '
                           'name one')
    port: str | None = options.port or options.port_given
    return port


def _usual_port(machine: Machine) -> str:
    found = usb_port.candidates(machine)
    return found[0] if len(found) == 1 else DEFAULT_PORT


def _rule() -> str:
    """Return the path of the udev rule, installed or in the sources."""
    with contextlib.suppress(ImportError, LookupError, OSError):
        from ament_index_python.packages import get_package_share_directory
        installed = Path(get_package_share_directory('bahrs_driver')) / 'config' / usb_port.RULE
        if installed.exists():
            return str(installed)
    sources = [Path(__file__).resolve().parents[2] / 'config' / usb_port.RULE,
               Path(sys.prefix) / 'share/bahrs_driver/config' / usb_port.RULE]
    return str(next((path for path in sources if path.exists()), sources[0]))


def _show(console: Console, result: CheckResult) -> None:
    line = Text(f'{result.level.value:<8}', _STYLES[result.level])
    console.print(line + Text(f'{result.check}: ', 'bold') + Text(_shown(result.message)))
    if result.command:
        console.print(Text(f'{"":<8}-> ', 'dim') + Text(_shown(result.command), 'cyan'))


def _shown(text: str) -> str:
    # Names of devices, processes, nodes and variables may contain any characters.
    return printable(text, LONGEST_LINE)
