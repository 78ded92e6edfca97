# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs doctor`: why there is no data, and the command that fixes it."""

import argparse
from collections.abc import Iterator
import contextlib
from functools import partial
from importlib.util import find_spec
import json
import os
from pathlib import Path
import sys

from bahrs_driver.doctor import listening, ros_environment, ros_logging, usb_port
from bahrs_driver.doctor.commands import RUN_DRIVER, run_driver
from bahrs_driver.doctor.finding import Finding, Level, problem
from bahrs_driver.doctor.machine import Machine
from bahrs_driver.errors import CommandError, RosStartError
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.start import check_import, start_errors
from rich.console import Console
from rich.text import Text

DEFAULT_PORT = '/dev/ttyUSB0'
LONGEST_LINE = 2000     # characters of a message or command
_BEFORE_START = ('middleware', 'domain', 'logging')      # checks without which ROS cannot start
_STYLES = {Level.OK: 'green', Level.ADVICE: 'yellow', Level.PROBLEM: 'bold red'}
_EXAMPLES = """examples:
  bahrs doctor                                  the only adapter that is plugged in
  bahrs doctor /dev/ttyUSB1 --json              for a script
  bahrs doctor --ask                            a Titan-M must be asked

exit status: 0 if nothing is wrong, 1 if there is a problem; advice is no problem
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Look at the port, its adapter, who else uses it, which device speaks on it and how\n'
        'fast, and at the set-up of ROS and who listens. Each finding comes with the command\n'
        'that fixes it. Nothing is written to the device, but with --ask.')
    parser.epilog = _EXAMPLES
    parser.add_argument('port_given', nargs='?', metavar='PORT',
                        help='path or URL (default: the only adapter there is, or '
                             f'{DEFAULT_PORT})')
    parser.add_argument('--port', help='the same as PORT')
    parser.add_argument('--baud-rate', type=int, default=115200, metavar='BAUD',
                        help='rate to listen at first (default: %(default)s)')
    parser.add_argument('--namespace', metavar='NAME',
                        help='namespace of the driver, / for the root (default: any)')
    parser.add_argument('--no-listen', action='store_true',
                        help='do not open the port')
    parser.add_argument('--ask', action='store_true',
                        help='write requests to find a device that only answers; without this '
                             'nothing is ever written')
    parser.add_argument('--json', action='store_true',
                        help='print one JSON array of check, level, message and command')
    parser.add_argument('--root', type=Path, default=Path('/'), help=argparse.SUPPRESS)


def run(options: argparse.Namespace) -> int:
    """Look at everything; 1 if there is a problem."""
    has_rclpy = _has_rclpy()
    options.port = _one_port(options)
    if 'rclpy' in sys.modules:
        from bahrs_driver.cli.node_options import selected_namespace        # needs ROS
        options.namespace = selected_namespace(options)
    findings = []
    console = Console(soft_wrap=True, highlight=False)
    for finding in _findings(options, has_rclpy):
        if not os.environ.get('AMENT_PREFIX_PATH'):         # there is no ros2 command then
            finding = finding._replace(
                command=finding.command.replace(RUN_DRIVER, 'driver_node'))
        findings.append(finding)
        if not options.json:
            _show(console, finding)
    if options.json:
        print(json.dumps([{**finding._asdict(), 'level': finding.level.value}
                          for finding in findings], indent=2))
    return int(any(finding.level is Level.PROBLEM for finding in findings))


def _findings(options: argparse.Namespace, has_rclpy: bool) -> Iterator[Finding]:
    machine = Machine(options.root)
    port = options.port or _usual_port(machine)
    is_path = '://' not in port
    if is_path:
        port = os.path.abspath(port)
    may_listen, heard = not options.no_listen, None
    for finding in usb_port.look_at_port(machine, port, _rule()) if is_path else ():
        yield finding
        if finding.check in ('port', 'access') and finding.level is Level.PROBLEM \
                or finding.check == 'in use' and 'open in' in finding.message:
            may_listen = False
    if may_listen:
        heard = yield from listening.look(str(machine.path(port)) if is_path else port,
                                          options.baud_rate, ask=options.ask)
    # What was recognised is part of every command that starts a driver for it.
    run_it = partial(run_driver, sensor=heard.sensor, baud_rate=heard.baud_rate) if heard \
        else partial(run_driver, baud_rate=options.baud_rate)
    if is_path:
        yield from usb_port.look_at_name(machine, port, _rule(), run_it)
    may_join = has_rclpy
    for finding in _of_ros(machine, has_rclpy):
        yield finding
        if finding.check in _BEFORE_START and finding.level is Level.PROBLEM:
            may_join = False            # ROS would not start
    if may_join:
        yield from _graph(options, port, run_it(port))


def _of_ros(machine: Machine, has_rclpy: bool) -> Iterator[Finding]:
    yield from ros_environment.look(machine.environment, has_rclpy, Path(sys.prefix))
    if has_rclpy:
        yield from ros_logging.look(machine.environment)


def _has_rclpy() -> bool:
    # Before anything is printed: from PyPI, rclpy may restart Python to set up its libraries.
    try:
        check_import()
        import rclpy  # noqa: F401
    except ImportError:
        return False
    except RosStartError:
        return find_spec('rclpy') is not None       # importing it would end the process
    return True


def _graph(options: argparse.Namespace, port: str, command: str) -> Iterator[Finding]:
    from bahrs_driver.cli.ros import ros_session        # needs ROS, the doctor must run without
    from bahrs_driver.doctor import graph
    import rclpy
    try:
        with ros_session(options) as keep:
            with start_errors(options.ros_arguments):
                node = keep(rclpy.create_node(f'bahrs_doctor_{os.getpid()}',
                                              namespace=options.namespace))
            yield from graph.look(node, port, command=command, namespace=options.namespace)
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
    """Return where the udev rule is: installed, or in the sources."""
    with contextlib.suppress(ImportError, LookupError, OSError):
        from ament_index_python.packages import get_package_share_directory
        installed = Path(get_package_share_directory('bahrs_driver')) / 'config' / usb_port.RULE
        if installed.exists():
            return str(installed)
    beside = [Path(__file__).resolve().parents[2] / 'config' / usb_port.RULE,
              Path(sys.prefix) / 'share/bahrs_driver/config' / usb_port.RULE]
    return str(next((path for path in beside if path.exists()), beside[0]))


def _show(console: Console, finding: Finding) -> None:
    line = Text(f'{finding.level.value:<8}', _STYLES[finding.level])
    console.print(line + Text(f'{finding.check}: ', 'bold') + Text(_shown(finding.message)))
    if finding.command:
        console.print(Text(f'{"":<8}-> ', 'dim') + Text(_shown(finding.command), 'cyan'))


def _shown(text: str) -> str:
    # Names of devices, processes, nodes and variables are in it, which are not ours.
    return printable(text, LONGEST_LINE)
