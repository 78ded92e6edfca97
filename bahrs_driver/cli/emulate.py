# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs emulate`: a sensor made of software, on a port or into a file."""

import argparse
from collections.abc import Callable, Iterator
import contextlib
import math
import signal
import sys
from typing import Any, TypeVar

from bahrs_driver.cli.errors import CommandError
from bahrs_driver.emulator.bahrs_device import BahrsDevice, BahrsHabits, START_UPS
from bahrs_driver.emulator.bahrs_diagnostics import INACTIVITY, ServiceHabits
from bahrs_driver.emulator.cable import adapter_mode, Cable
from bahrs_driver.emulator.control import COMMANDS, ControlError
from bahrs_driver.emulator.device_clock import DeviceClock
from bahrs_driver.emulator.emulation import Emulation
from bahrs_driver.emulator.faults import Faults, NAMES as FAULTS, parse_fault
from bahrs_driver.emulator.flights import MOTIONS
from bahrs_driver.emulator.noise import DEVIATIONS, Noise, parse_bias, parse_deviation
from bahrs_driver.emulator.nvm_image import made_up_image, SIZE
from bahrs_driver.emulator.pulses import Pulses
from bahrs_driver.emulator.runner import ControlInput, PacedRun, run_to_file
from bahrs_driver.emulator.scenario import parse, TimedCommand
from bahrs_driver.emulator.session import Session
from bahrs_driver.emulator.texts import number, whole
from bahrs_driver.emulator.truth_file import HostTime, TruthFile
from bahrs_driver.protocol.bahrs import VERSIONS
from bahrs_driver.protocol.nvm import PAGES

Value = TypeVar('Value')

_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_EXAMPLES = """examples:
  bahrs emulate --link /tmp/bahrs                     an aircraft in flight, on a port
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
  bahrs emulate --latency-timer 16 --fault bit_flip=0.0001 --truth truth.jsonl
  bahrs emulate --output flight.bin --duration 1300   as fast as it goes, into a file
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Make a serial port (a pseudo-terminal), print its path, and behave on it as a sensor in\n'
        'motion does. The same seed and options give the same bytes.')
    parser.epilog = _epilog()
    for add in (_add_run, _add_motion, _add_device, _add_service, _add_cable):
        add(parser)


def _add_run(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--sensor', choices=('bahrs',), default='bahrs',
                        help='which device to be (default: %(default)s)')
    parser.add_argument('--link', metavar='PATH', help='make a symbolic link to the port')
    parser.add_argument('--wait', action='store_true',
                        help='stay switched off until somebody opens the port')
    parser.add_argument('--output', metavar='FILE',
                        help='no port: write the bytes into a file, as fast as possible')
    parser.add_argument('--duration', type=_number('a duration'), default=math.inf,
                        metavar='SECONDS', help='end after this long (default: never)')
    parser.add_argument('--seed', type=int, default=1, metavar='NUMBER',
                        help='of all that is random (default: %(default)s)')
    parser.add_argument('--truth', metavar='FILE',
                        help='write what was really so, one JSON object a line for each frame')
    parser.add_argument('--scenario', metavar='FILE',
                        help='commands to carry out, each after its seconds since the start: '
                             '"12.5 integrity roll risk"')


def _add_motion(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('motion and its measurement')
    group.add_argument('--motion', choices=tuple(MOTIONS), default='flight',
                       help='how it moves (default: %(default)s)')
    group.add_argument('--noise', type=_checked(parse_deviation), action='append', default=[],
                       metavar='NAME=STDDEV',
                       help='white noise in SI units, again for each quantity (default: '
                            + ', '.join(f'{name}={value:g}'
                                        for name, value in DEVIATIONS.items()) + ')')
    group.add_argument('--bias', type=_checked(parse_bias), action='append', default=[],
                       metavar='NAME=VALUE[,VALUE,VALUE]',
                       help='constant error in SI units, for each component (default: 0)')


def _add_device(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('device')
    group.add_argument('--protocol-version', type=int, choices=VERSIONS, default=3,
                       help='of the protocol that it speaks (default: %(default)s)')
    group.add_argument('--crc', choices=('word', 'byte'), default='word',
                       help='how the CRC takes the bytes: as 32-bit words, as real devices do, '
                            'or one by one, as the document says (default: %(default)s)')
    group.add_argument('--time-label', choices=('next', 'same'), default='next',
                       help='whether time messages name the sample after the one that they are '
                            'about, as real devices do, or that one (default: %(default)s)')
    group.add_argument('--start-up', choices=tuple(START_UPS), default='prompt',
                       help='first sample 0.6 s after power-on, or 2.6 s and then 2.7 s of '
                            'silence, as in a recording (default: %(default)s)')
    group.add_argument('--drift-ppm', type=_number('a drift', -1e5, 1e5), default=0.0,
                       metavar='PPM', help='how much too fast its clock is (default: 0)')
    group.add_argument('--wander-ppm', type=_number('a wander', 0, 1e3), default=0.0,
                       metavar='PPM', help='random walk of the drift, per square root of a '
                                           'second (default: 0)')
    group.add_argument('--clock-start', type=_checked(_device_time), default=0, metavar='US',
                       help='device time at power-on, in microseconds (default: 0)')
    group.add_argument('--sync-pulse-rate', type=_number('a rate', 0, 1000), default=0.0,
                       metavar='HZ', help='pulses at whole multiples of the period in UNIX time; '
                       'the device ignores what comes sooner than 90 ms (default: 0, none)')
    group.add_argument('--debug-rate', type=_number('a rate', 0, 200), default=0.0, metavar='HZ',
                       help='of the undocumented messages 0xC0 and 0xC1 (default: 0, none)')
    group.add_argument('--output-delay', type=_number('a delay', 0, 1000), default=0.0,
                       metavar='MS', help='from a sample to the first byte that tells of it, in '
                                          'milliseconds (default: 0)')


def _add_service(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('diagnostics mode')
    group.add_argument('--nvm', type=_checked(_image), metavar='FILE',
                       help=f'image of the memory, {SIZE:,} bytes (default: one made up)')
    group.add_argument('--nvm-window', choices=('always', 'power-on'), default='always',
                       help='when the device lets a host in: always, or in the first 0.5 s after '
                            'power-on, as known firmware does (default: %(default)s)')
    group.add_argument('--nvm-error-pages', type=_checked(_pages), default=frozenset(),
                       metavar='PAGE[,PAGE...]', help='pages that cannot be read (default: none)')
    group.add_argument('--nvm-timeout', type=_number('a time-out'), default=INACTIVITY,
                       metavar='SECONDS', help='after how long without a request the device '
                       'leaves by itself (default: %(default)g)')
    group.add_argument('--service-crc', choices=('crc32', 'mpeg2'), default='crc32',
                       help="CRC of service frames: CRC-32, as the maker's tool has it, or "
                            'CRC-32/MPEG-2, as the document says (default: %(default)s)')
    group.add_argument('--service-padding', choices=('no', 'yes'), default='no',
                       help="whether 0xF0 and 0xF1 must be padded: no, as the maker's tool sends "
                            'them, or yes, as the document says (default: %(default)s)')


def _add_cable(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('cable')
    group.add_argument('--baud-rate', type=_number('a baud rate', 1200, 4e6), default=115200,
                       metavar='BAUD', help='of the line, always 8N1 (default: %(default)s)')
    group.add_argument('--latency-timer', type=_checked(adapter_mode), default='none',
                       metavar='MS', help='how long an adapter holds bytes back, 1 to 255 ms; '
                       '"packets" for one that hands over eight full packets at a time, "none" '
                       'for none (default: %(default)s)')
    group.add_argument('--fault', type=_checked(parse_fault), action='append', default=[],
                       metavar='NAME=RATE',
                       help='damage what is sent, see below; again for each kind')


def run(options: argparse.Namespace) -> int:
    """Emulate until the duration is over, or a command or a signal ends it."""
    if options.output and not math.isfinite(options.duration):
        raise CommandError('--output needs --duration SECONDS: the motion has no end')
    scenario = _scenario(options.scenario)
    with contextlib.ExitStack() as stack:
        truth_file = TruthFile(stack.enter_context(_opened(options.truth, 'w'))) \
            if options.truth else None

        def session(zero: HostTime) -> Session:
            return Session(_emulation(options, zero), scenario, truth_file)

        try:
            if options.output:
                _run_to_file(options, session(HostTime()))
            else:
                _run_on_port(options, session)
        except OSError as error:
            raise CommandError(f'cannot go on: {error}') from error
    return 0


def _run_to_file(options: argparse.Namespace, session: Session) -> None:
    with _opened(options.output, 'wb') as file:
        try:
            run_to_file(session, options.duration, file)
        except ControlError as error:
            raise CommandError(f'{options.scenario}: {error}') from error
    _report(session.emulation)


def _run_on_port(options: argparse.Namespace, make: Callable[[HostTime], Session]) -> None:
    paced = PacedRun(options.link, ControlInput(0 if sys.stdin else None), _announce, _complain)
    with _signals_call(paced.end), paced:
        session = make(paced.start(options.wait))
        paced.run(session, options.duration)
    _report(session.emulation, paced.lost)


@contextlib.contextmanager
def _signals_call(end: Callable[[], None]) -> Iterator[None]:
    """Let Ctrl-C and its relatives end the emulator, for they are the usual way to do so."""
    handlers: dict[signal.Signals, Any] = dict.fromkeys(_ENDING, lambda *_: end())
    # In the background of a shell the terminal is not ours to read; reading then fails, no more.
    handlers[signal.SIGTTIN] = signal.SIG_IGN
    before = {kind: signal.signal(kind, handler) for kind, handler in handlers.items()}
    try:
        yield
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)


def _emulation(options: argparse.Namespace, zero: HostTime) -> Emulation:
    habits = BahrsHabits(
        options.protocol_version, options.crc, options.time_label, options.start_up,
        options.debug_rate, options.output_delay / 1000, _service(options))
    noise = Noise(options.seed, {**DEVIATIONS, **dict(options.noise)}, dict(options.bias))
    clock = DeviceClock(options.seed, options.drift_ppm, options.wander_ppm, options.clock_start)
    pulses = Pulses(options.sync_pulse_rate, origin=-(zero.unix_ns % 10 ** 9) / 1e9)
    device = BahrsDevice(habits, MOTIONS[options.motion](), noise, clock, pulses)
    cable = Cable(options.baud_rate, options.latency_timer)
    return Emulation(device, Faults(options.seed, dict(options.fault)), cable)


def _service(options: argparse.Namespace) -> ServiceHabits:
    return ServiceHabits(
        'crc32' if options.service_crc == 'crc32' else 'byte', options.service_padding == 'yes',
        options.nvm_window, options.nvm_error_pages, options.nvm or made_up_image(),
        options.nvm_timeout)


def _scenario(name: str | None) -> list[TimedCommand]:
    if name is None:
        return []
    try:
        with _opened(name, 'r') as file:
            return parse(file)
    except ValueError as error:
        raise CommandError(f'{name}: {error}') from error


def _opened(name: str, mode: str) -> Any:
    try:
        return open(name, mode)
    except OSError as error:
        action = 'write' if 'w' in mode else 'read'
        raise CommandError(f'cannot {action} {name}: {error.strerror}') from error


def _report(emulation: Emulation, lost: int = 0) -> None:
    """Tell on standard error what was sent, and what became of it."""
    rows = [(name, count) for counter in (
        emulation.counts, emulation.wire_counts, emulation.faults.counts)
        for name, count in counter.items()]
    if lost:
        rows.append(('bytes nobody took', lost))
    for name, count in rows:
        print(f'{name:<22}{count:>12,}', file=sys.stderr)


def _announce(name: str) -> None:
    print(name, flush=True)


def _complain(sentence: str) -> None:
    print(f'bahrs emulate: {sentence}', file=sys.stderr, flush=True)


def _epilog() -> str:
    lines = [_EXAMPLES, 'faults, with a rate from 0 to 1 for each byte or frame:']
    lines += [f'  {name:<28}{text}' for name, text in FAULTS.items()]
    lines += ['', 'commands, a line each on standard input or in a scenario:']
    lines += [f'  {name + " " + command.arguments:<28}{command.summary}'
              for name, command in COMMANDS.items()]
    return '\n'.join(lines)


def _checked(parse_text: Callable[[str], Value]) -> Callable[[str], Value]:
    """Return the same function for argparse, which shows only its own kind of error."""
    def parse_argument(text: str) -> Value:
        try:
            return parse_text(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error
    return parse_argument


def _number(what: str, low: float = 0.0, high: float = math.inf) -> Callable[[str], float]:
    return _checked(lambda text: number(text, what, low, high))


def _device_time(text: str) -> int:
    return whole(text, 'the device time', 0, 2 ** 62)


def _pages(text: str) -> frozenset[int]:
    return frozenset(whole(word, 'a page', 0, PAGES - 1) for word in text.split(','))


def _image(name: str) -> bytes:
    with _opened(name, 'rb') as file:
        image: bytes = file.read()
    if len(image) != SIZE:
        raise ValueError(f'{name} has {len(image):,} bytes: an image has {SIZE:,}')
    return image
