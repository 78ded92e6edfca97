# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs emulate`: simulate a device on a pseudo-terminal or into a file."""

import argparse
from collections.abc import Callable, Iterator
import contextlib
from functools import partial
import math
import signal
import sys
from typing import Any

from bahrs_driver.cli.cable_options import add_cable_options, FAULTS_HELP
from bahrs_driver.cli.outputs import add_force, live_output, output_file, same_output
from bahrs_driver.cli.printing import print_counts, warn
from bahrs_driver.devices.registry import DEFAULT, DEVICES, examples
from bahrs_driver.emulator.control import COMMANDS
from bahrs_driver.emulator.control_input import ControlInput
from bahrs_driver.emulator.emulation import Emulation
from bahrs_driver.emulator.flights import MOTIONS
from bahrs_driver.emulator.measurement_errors import (
    DEVIATIONS,
    MeasurementErrors,
    parse_bias,
    parse_deviation,
)
from bahrs_driver.emulator.runner import RealTimeRun, run_to_file
from bahrs_driver.emulator.scenario import parse, TimedCommand
from bahrs_driver.emulator.session import EmulationSession
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.emulator.truth_file import TruthFile
from bahrs_driver.errors import CommandError, ControlError, WriteError
from bahrs_driver.files.guard import reason
from bahrs_driver.process.argument_types import argument_type, bounded_float, open_input
from bahrs_driver.process.printable import printable
from bahrs_driver.process.shutdown_event import handled_signals
from bahrs_driver.virtual_serial.cable import AT_ONCE, Cable
from bahrs_driver.virtual_serial.faults import Faults

_EXAMPLES = """examples:
  bahrs emulate --link /tmp/bahrs                     simulate a flight on a port
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
  bahrs emulate --latency-timer 16 --fault bit_flip=0.0001 --truth truth.jsonl
  bahrs emulate --output flight.bin --duration 1300   as fast as possible, to a file
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Create a serial port (a pseudo-terminal), print its path, and simulate a device in\n'
        'motion on it. The same seed and options give the same bytes.')
    parser.epilog = _epilog()
    _add_general_options(parser)
    _add_motion_options(parser)
    for spec in DEVICES.values():
        spec.emulation().add_arguments(parser)
    add_cable_options(parser, AT_ONCE, '%(default)s')


def _add_general_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--sensor', choices=tuple(DEVICES), default=DEFAULT,
                        help='device to simulate (default: %(default)s)')
    parser.add_argument('--link', metavar='PATH', help='create a symbolic link to the port')
    parser.add_argument('--wait', action='store_true',
                        help='switch the device on when a program opens the port')
    parser.add_argument('--output', metavar='FILE',
                        help='write the bytes to a file, as fast as possible; - is standard '
                             'output')
    parser.add_argument('--duration', type=bounded_float('a duration'), default=math.inf,
                        metavar='SECONDS', help='end after this time (default: never)')
    parser.add_argument('--baud-rate', type=bounded_float('a baud rate', 1200, 4e6),
                        default=115200, metavar='BAUD',
                        help='speed of the serial line, always 8N1 (default: %(default)s)')
    parser.add_argument('--seed', type=int, default=1, metavar='NUMBER',
                        help='seed of all random numbers (default: %(default)s)')
    parser.add_argument('--truth', metavar='FILE',
                        help='write ground truth, one JSON line per frame; - is standard output')
    add_force(parser)
    parser.add_argument('--scenario', metavar='FILE',
                        help='file of commands, each after its time in seconds since the start: '
                             '"12.5 integrity roll risk"')


def _add_motion_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('motion and its measurement')
    group.add_argument('--motion', choices=tuple(MOTIONS), default='flight',
                       help='motion of the vehicle (default: %(default)s)')
    group.add_argument('--noise', type=argument_type(parse_deviation), action='append', default=[],
                       metavar='NAME=STDDEV',
                       help='white noise in SI units; repeat for each quantity (default: '
                            + ', '.join(f'{name}={value:g}'
                                        for name, value in DEVIATIONS.items()) + ')')
    group.add_argument('--bias', type=argument_type(parse_bias), action='append', default=[],
                       metavar='NAME=VALUE[,VALUE,VALUE]',
                       help='constant error of each component in SI units (default: 0)')


def run(options: argparse.Namespace) -> int:
    """Emulate until the duration is over, or a command or a signal ends it."""
    if options.output and not math.isfinite(options.duration):
        raise CommandError('--output needs --duration SECONDS: the motion has no end')
    if options.truth and same_output(options.truth, options.output):
        raise CommandError(f'--truth and --output are both {printable(options.output)}: choose '
                           'another name for one of them')
    _reject_options_of_other_devices(options)
    scenario = _scenario(options.scenario)
    with contextlib.ExitStack() as stack:
        truth_file = TruthFile(stack.enter_context(live_output(options.truth, options.force))) \
            if options.truth else None

        def session(start_time: StartTime) -> EmulationSession:
            return EmulationSession(_emulation(options, start_time), scenario, truth_file)

        try:
            if options.output:
                _run_to_file(options, session(StartTime()))
            else:
                _run_on_port(options, session)
        except BrokenPipeError:         # the reader of standard output has closed it
            raise
        except (OSError, WriteError) as error:
            raise CommandError(f'cannot continue: {reason(error)}') from error
    return 0


def _reject_options_of_other_devices(options: argparse.Namespace) -> None:
    """Raise CommandError for an option of another device, which would have no effect."""
    for name, spec in DEVICES.items():
        if name != options.sensor:
            parser = argparse.ArgumentParser(add_help=False)
            spec.emulation().add_arguments(parser)
            for dest, default in vars(parser.parse_args([])).items():
                if getattr(options, dest) != default:
                    raise CommandError(f"--{dest.replace('_', '-')} is an option of a {name}, "
                                       f'not of a {options.sensor}')


def _run_to_file(options: argparse.Namespace, session: EmulationSession) -> None:
    with output_file(options.output, options.force) as file:
        try:
            run_to_file(session, options.duration, file)
        except ControlError as error:
            raise CommandError(f'{options.scenario}: {error}') from error
    _report(session.emulation)


def _run_on_port(options: argparse.Namespace,
                 make_session: Callable[[StartTime], EmulationSession]) -> None:
    real_time = RealTimeRun(options.link, ControlInput(0 if sys.stdin else None),
                            partial(print, flush=True), partial(warn, 'emulate'))
    with _call_on_signals(real_time.end), real_time:
        session = make_session(real_time.start(options.wait))
        real_time.run(session, options.duration)
    _report(session.emulation, real_time.lost)


@contextlib.contextmanager
def _call_on_signals(end: Callable[[], None]) -> Iterator[None]:
    """Call a function at Ctrl-C and similar signals, which usually end the emulator."""
    handlers: dict[signal.Signals, Any] = dict.fromkeys(handled_signals(), lambda *_: end())
    # In the background of a shell, reading the terminal then fails instead of stopping us.
    handlers[signal.SIGTTIN] = signal.SIG_IGN
    before = {kind: signal.signal(kind, handler) for kind, handler in handlers.items()}
    try:
        yield
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)


def _emulation(options: argparse.Namespace, start_time: StartTime) -> Emulation:
    errors = MeasurementErrors(options.seed, {**DEVIATIONS, **dict(options.noise)},
                               dict(options.bias))
    device = DEVICES[options.sensor].emulation().make_device(
        options, MOTIONS[options.motion](), errors, start_time)
    cable = Cable(options.baud_rate, options.latency_timer)
    return Emulation(device, Faults(options.seed, dict(options.fault)), cable)


def _scenario(name: str | None) -> list[TimedCommand]:
    if name is None:
        return []
    try:
        with open_input(name, 'r') as file:
            return parse(file)
    except ValueError as error:
        raise CommandError(f'{name}: {error}') from error


def _report(emulation: Emulation, bytes_not_read: int = 0) -> None:
    """Print the counts of frames and faults on standard error."""
    counts = [*emulation.counts.items(), *emulation.fate_counts.items(),
              *emulation.faults.counts.items()]
    if bytes_not_read:
        counts.append(('bytes not read', bytes_not_read))
    print_counts(counts, sys.stderr)


def _epilog() -> str:
    lines = [_EXAMPLES + examples('emulate'), FAULTS_HELP, '',
             'commands, one per line on standard input or in a scenario:']
    lines += [f'  {name + " " + command.arguments:<28}{command.summary}'
              for name, command in COMMANDS.items()]
    return '\n'.join(lines)
