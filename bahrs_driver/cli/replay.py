# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs replay`: a recorded stream of bytes, on a port, as the device sent it."""

import argparse
from collections.abc import Iterator
import json
import sys
import time

from bahrs_driver.bag.capture import Capture, PIECE
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.read_capture import read_capture
from bahrs_driver.cli.files import binary_input, STANDARD_INPUT
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
LONGEST_UNREAD = 60.0       # s that a reader may take for the last bytes
REOPEN_TIMEOUT = 10.0       # s; a driver that was started again opens the port within a few

_EXAMPLES = """examples:
  bahrs replay flight.bin --link /tmp/bahrs       bytes, at the rates of the device
  bahrs replay flight --link /tmp/bahrs           a bag with raw, at its own times
  bahrs replay flight --fault bit_flip=0.0001 --latency-timer 16
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Make a serial port (a pseudo-terminal), print its path, wait until somebody opens\n'
        'it, and play what a device sent: a bag that holds raw at its own times, a file of\n'
        'bytes at the message rates of the device. Playing pauses while no reader has the\n'
        'port open.')
    parser.epilog = '\n'.join([
        _EXAMPLES, 'faults, with a rate from 0 to 1 for each byte or frame:',
        *(f'  {name:<28}{text}' for name, text in FAULTS.items())])
    parser.add_argument('file', help='bag that holds the topic raw, or file of bytes as the '
                                     'device sent them; - is standard input')
    parser.add_argument('--link', metavar='PATH', help='make a symbolic link to the port')
    parser.add_argument('--rate', type=positive_float, default=1.0, metavar='FACTOR',
                        help='how many times faster than it was (default: %(default)s)')
    parser.add_argument('--loop', action='store_true', help='begin again at the end')
    parser.add_argument('--settle', type=bounded_float('a time', 0.0), default=0.5,
                        metavar='SECONDS',
                        help='time given to whoever opens the port before the first byte '
                             '(default: %(default)s)')
    parser.add_argument('--reopen-timeout', type=bounded_float('a time', 0.0), metavar='SECONDS',
                        help='how long to wait, when the port has been closed, until it is opened '
                             f'again (default: {REOPEN_TIMEOUT:g}, with --loop no limit)')
    parser.add_argument('--topic', metavar='NAME',
                        help='topic of the bytes, for a bag with several')
    parser.add_argument('--json', action='store_true',
                        help='print what was played as a JSON object at the end')
    parser.add_argument('--sensor', choices=tuple(DEVICES),
                        help='whose frames faults are put on (default: as the bag says, or '
                             f'{DEFAULT})')
    group = parser.add_argument_group('cable')
    group.add_argument('--fault', type=argument_type(parse_fault), action='append', default=[],
                       metavar='NAME=RATE', help='damage what is sent, see below; again for each')
    group.add_argument('--latency-timer', type=argument_type(adapter_mode), metavar='MS',
                       help='how long an adapter holds bytes back, 1 to 255 ms; "packets" for '
                            'one that hands over eight full packets at a time (default: as it '
                            'was)')
    group.add_argument('--seed', type=int, default=1, metavar='NUMBER',
                       help='of the faults (default: %(default)s)')


def run(options: argparse.Namespace) -> int:
    """Play the file; Ctrl-C ends it. 1 if its reader has gone before the end."""
    if options.file == STANDARD_INPUT:
        with binary_input(options.file) as file:
            content = file.read()
        capture = None
    else:
        content, capture = b'', read_capture(options.file, options.topic)
        if not capture.size:
            raise CommandError(f'{printable(options.file)} is empty: there is nothing to play')
    options.sensor = sensor_of(capture, options.sensor)
    faults = Faults(options.seed, dict(options.fault))
    try:
        port = PtyPort(options.link)
    except (OSError, WriteError) as error:
        raise CommandError(f'cannot make the port: {reason(error)}') from error
    patience = options.reopen_timeout
    if patience is None and not options.loop:
        patience = REOPEN_TIMEOUT
    player = Player(port, options.rate, options.settle, patience,
                    lambda text: print(f'bahrs replay: {text}', file=sys.stderr))
    with port:
        print(port.name, flush=True)
        port.wait_until_open()
        time.sleep(options.settle)
        complete = again = True
        while complete and again:
            pieces = _timed(capture) if capture and capture.timed else \
                paced(_bytes(capture) if capture else [content], _framer(options),
                      DEVICES[options.sensor].frame_period)
            complete = player.play(_over_cable(options, pieces, faults))
            again = options.loop
        # What is still unread would vanish with the port.
        if complete:
            time.sleep(options.settle)
            port.wait_until_read(LONGEST_UNREAD)
    notes = capture.notes if capture else []
    if not complete:
        notes.append('no reader opened the port again: the rest was not played')
    _report(options, player.played, faults, notes)
    return 0 if complete else 1


def _framer(options: argparse.Namespace) -> Framer:
    return Framer(DEVICES[options.sensor].frame_format())


def _timed(capture: Capture) -> Iterator[Piece]:
    """Return what was read, and when since the first read."""
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
        print(f'bahrs replay: {note}', file=sys.stderr)
    if options.json:
        print(json.dumps({'bytes': played, 'faults': dict(faults.counts), 'notes': notes}))
        return
    print(f'played {played:,} bytes', file=sys.stderr)
    for name, count in faults.counts.items():
        print(f'{name:<22}{count:>12,}', file=sys.stderr)
