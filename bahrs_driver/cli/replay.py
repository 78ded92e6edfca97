# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs replay`: play a recorded stream of bytes on a pseudo-terminal."""

import argparse
from collections.abc import Iterator
import json
import sys
import time

from bahrs_driver.bag.capture import Capture, PIECE
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.read_capture import read_capture
from bahrs_driver.cli.inputs import binary_input, STANDARD_INPUT
from bahrs_driver.cli.sensors import sensor_of
from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.errors import CommandError, WriteError
from bahrs_driver.files.guard import reason
from bahrs_driver.process.argument_types import argument_type, bounded_float, positive_float
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.units import NS_PER_S
from bahrs_driver.virtual_serial.cable import adapter_mode, AT_ONCE, Cable
from bahrs_driver.virtual_serial.faults import Faults, parse_fault
from bahrs_driver.virtual_serial.faults import NAMES as FAULTS
from bahrs_driver.virtual_serial.pacing import paced, Piece, through
from bahrs_driver.virtual_serial.player import Player
from bahrs_driver.virtual_serial.pty_port import PtyPort

BAUD_RATE = 115200
LONGEST_UNREAD = 60.0       # s for a reader to take the last bytes
REOPEN_TIMEOUT = 10.0       # s; a restarted driver opens the port sooner

_EXAMPLES = """examples:
  bahrs replay flight.bin --link /tmp/bahrs       bytes, at the rates of the device
  bahrs replay flight --link /tmp/bahrs           a bag with raw, at its own times
  bahrs replay flight --fault bit_flip=0.0001 --latency-timer 16
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Create a serial port (a pseudo-terminal), print its path, wait until a program opens\n'
        'it, and play a recorded stream: a bag with the topic raw at its own times, a file of\n'
        'bytes at the message rates of the device. Playing pauses while no program has the\n'
        'port open.')
    parser.epilog = '\n'.join([
        _EXAMPLES, 'faults, with a rate from 0 to 1 for each byte or frame:',
        *(f'  {name:<28}{text}' for name, text in FAULTS.items())])
    parser.add_argument('file', help='bag with the topic raw, or file of bytes from the device; '
                                     '- is standard input')
    parser.add_argument('--link', metavar='PATH', help='create a symbolic link to the port')
    parser.add_argument('--rate', type=positive_float, default=1.0, metavar='FACTOR',
                        help='speed relative to the recording (default: %(default)s)')
    parser.add_argument('--loop', action='store_true', help='restart at the end')
    parser.add_argument('--settle', type=bounded_float('a time', 0.0), default=0.5,
                        metavar='SECONDS',
                        help='time from the opening of the port to the first byte '
                             '(default: %(default)s)')
    parser.add_argument('--reopen-timeout', type=bounded_float('a time', 0.0), metavar='SECONDS',
                        help='how long to wait for a closed port to be opened again '
                             f'(default: {REOPEN_TIMEOUT:g}, with --loop no limit)')
    parser.add_argument('--topic', metavar='NAME',
                        help='topic of the bytes, for a bag with several')
    parser.add_argument('--json', action='store_true', help='print the result as one JSON object')
    parser.add_argument('--sensor', choices=tuple(DEVICES),
                        help='which device sent it, for faults and message rates (default: as '
                             f'the bag says, or {DEFAULT})')
    _add_cable(parser)


def _add_cable(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group('cable')
    group.add_argument('--fault', type=argument_type(parse_fault), action='append', default=[],
                       metavar='NAME=RATE',
                       help='damage the stream, see below; repeat for each kind')
    group.add_argument('--latency-timer', type=argument_type(adapter_mode), metavar='MS',
                       help='how long the adapter holds bytes back, 1 to 255 ms; "packets" for '
                            'an adapter that delivers eight full packets at a time (default: '
                            'as recorded)')
    group.add_argument('--seed', type=int, default=1, metavar='NUMBER',
                       help='seed of the faults (default: %(default)s)')


def run(options: argparse.Namespace) -> int:
    """Play the file; 1 if the reader closes the port before the end."""
    capture, content = _input(options)
    options.sensor = sensor_of(capture, options.sensor)
    faults = Faults(options.seed, dict(options.fault))
    with _port(options.link) as port:
        player = Player(port, options.rate, options.settle, _reopen_timeout(options), _complain)
        print(port.name, flush=True)
        port.wait_until_open()
        time.sleep(options.settle)
        complete = again = True
        while complete and again:
            pieces = _pieces(options, capture, content)
            complete = player.play(_over_cable(options, pieces, faults))
            again = options.loop
        if complete:            # bytes that are unread when the port closes are lost
            time.sleep(options.settle)
            port.wait_until_read(LONGEST_UNREAD)
    notes = capture.notes if capture else []
    if not complete:
        notes.append('no program opened the port again: the rest was not played')
    _report(options, player.played, faults, notes)
    return 0 if complete else 1


def _input(options: argparse.Namespace) -> tuple[Capture | None, bytes]:
    """Return a capture, or the bytes of standard input."""
    if options.file == STANDARD_INPUT:
        with binary_input(options.file) as file:
            return None, file.read()
    capture = read_capture(options.file, options.topic)
    if not capture.size:
        raise CommandError(f'{printable(options.file)} is empty: there is nothing to play')
    return capture, b''


def _port(link: str | None) -> PtyPort:
    try:
        return PtyPort(link)
    except (OSError, WriteError) as error:
        raise CommandError(f'cannot create the port: {reason(error)}') from error


def _reopen_timeout(options: argparse.Namespace) -> float | None:
    if options.reopen_timeout is None and not options.loop:
        return REOPEN_TIMEOUT
    timeout: float | None = options.reopen_timeout
    return timeout


def _complain(sentence: str) -> None:
    print(f'bahrs replay: {sentence}', file=sys.stderr)


def _pieces(options: argparse.Namespace, capture: Capture | None,
            content: bytes) -> Iterator[Piece]:
    if capture and capture.timed:
        return _timed(capture)
    return paced(_bytes(capture) if capture else [content], _framer(options),
                 DEVICES[options.sensor].frame_period)


def _framer(options: argparse.Namespace) -> Framer:
    return Framer(DEVICES[options.sensor].frame_format())


def _timed(capture: Capture) -> Iterator[Piece]:
    """Yield the bytes of each read with its seconds since the first read."""
    log_clock, first = LogClock(), None
    for data, read_at, raw_at, _ in capture.chunks():
        at = log_clock.observe(read_at or 0, raw_at).raw_ns
        first = at if first is None else first
        yield (at - first) / NS_PER_S, data
    capture.notes.extend(log_clock.sentences())


def _bytes(capture: Capture) -> Iterator[bytes]:
    for chunk in capture.chunks():
        for start in range(0, len(chunk.data), PIECE):
            yield chunk.data[start:start + PIECE]


def _over_cable(options: argparse.Namespace, pieces: Iterator[Piece],
                faults: Faults) -> Iterator[Piece]:
    if not options.fault and options.latency_timer is None:
        return pieces
    cable = Cable(BAUD_RATE, options.latency_timer or AT_ONCE)
    return through(pieces, cable, faults, _framer(options))


def _report(options: argparse.Namespace, played: int, faults: Faults, notes: list[str]) -> None:
    for note in notes:
        _complain(note)
    if options.json:
        print(json.dumps({'bytes': played, 'faults': dict(faults.counts), 'notes': notes}))
        return
    print(f'played {played:,} bytes', file=sys.stderr)
    for name, count in faults.counts.items():
        print(f'{name:<22}{count:>12,}', file=sys.stderr)
