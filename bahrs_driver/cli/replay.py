# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs replay`: play a recorded stream of bytes on a pseudo-terminal."""

import argparse
from collections.abc import Iterator
from functools import partial
import json
import sys
import time

from bahrs_driver.bag.capture import Capture, PIECE
from bahrs_driver.bag.log_clock import LogClock
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.cli.cable_options import add_cable_options, FAULTS_HELP
from bahrs_driver.cli.capture_options import add_sensor_option, add_topic_option
from bahrs_driver.cli.inputs import binary_input, STANDARD_INPUT
from bahrs_driver.cli.printing import print_counts, warn
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.errors import CommandError, WriteError
from bahrs_driver.files.guard import reason
from bahrs_driver.process.argument_types import bounded_float, positive_float
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.reprocess.recording import sensor_of
from bahrs_driver.units import NS_PER_S
from bahrs_driver.virtual_serial.cable import AT_ONCE, Cable
from bahrs_driver.virtual_serial.faults import Faults
from bahrs_driver.virtual_serial.pacing import pace, Piece, transmit
from bahrs_driver.virtual_serial.player import Player
from bahrs_driver.virtual_serial.pty_port import PtyPort

BAUD_RATE = 115200
LONGEST_UNREAD = 60.0       # s for a reader to take the last bytes
REOPEN_TIMEOUT = 10.0       # s; a restarted driver opens the port sooner

_EXAMPLES = """examples:
  bahrs replay flight.bin --link /tmp/bahrs       a file, at the rates of the device
  bahrs replay flight --link /tmp/bahrs           a bag, at its own times
  bahrs replay flight --fault bit_flip=0.0001 --latency-timer 16
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Create a serial port (a pseudo-terminal), print its path, wait until a program opens\n'
        'it, and play a recording: a bag with the topic raw at its own times, a file of raw\n'
        'bytes at the message rates of the device. Playing pauses while no program has the\n'
        'port open.')
    parser.epilog = f'{_EXAMPLES}\n{FAULTS_HELP}'
    parser.add_argument('file', help='bag with the topic raw, or file of raw bytes; - is standard '
                                     'input')
    parser.add_argument('--link', metavar='PATH', help='create a symbolic link to the port')
    parser.add_argument('--rate', type=positive_float, default=1.0, metavar='FACTOR',
                        help='speed relative to the recording (default: %(default)s)')
    parser.add_argument('--loop', action='store_true', help='start again at the end')
    parser.add_argument('--settle', type=bounded_float('a time', 0.0), default=0.5,
                        metavar='SECONDS',
                        help='delay from the opening of the port to the first byte '
                             '(default: %(default)s)')
    parser.add_argument('--reopen-timeout', type=bounded_float('a time', 0.0), metavar='SECONDS',
                        help='longest time to wait until a closed port is opened again '
                             f'(default: {REOPEN_TIMEOUT:g}, with --loop no limit)')
    add_topic_option(parser)
    parser.add_argument('--json', action='store_true', help='print the result as one JSON object')
    add_sensor_option(parser)
    parser.add_argument('--seed', type=int, default=1, metavar='NUMBER',
                        help='seed of the faults (default: %(default)s)')
    add_cable_options(parser, None, 'as recorded')


def run(options: argparse.Namespace) -> int:
    """Play the file; 1 if the reader closes the port before the end."""
    capture, content = _read_input(options)
    options.sensor = sensor_of(capture, options.sensor)
    faults = Faults(options.seed, dict(options.fault))
    with _create_port(options.link) as port:
        player = Player(port, options.rate, options.settle, _reopen_timeout(options),
                        partial(warn, 'replay'))
        print(port.name, flush=True)
        port.wait_until_open()
        time.sleep(options.settle)
        complete = player.play(_pieces(options, capture, content, faults))
        while complete and options.loop:
            complete = player.play(_pieces(options, capture, content, faults))
        if complete:            # bytes that are unread when the port closes are lost
            time.sleep(options.settle)
            port.wait_until_read(LONGEST_UNREAD)
    notes = capture.notes if capture else []
    if not complete:
        notes.append('no program opened the port again: the rest was not played')
    _report(options, player.played, faults, notes)
    return 0 if complete else 1


def _read_input(options: argparse.Namespace) -> tuple[Capture | None, bytes]:
    """Return a capture, or the bytes of standard input."""
    if options.file == STANDARD_INPUT:
        with binary_input(options.file) as file:
            return None, file.read()
    capture = open_capture(options.file, options.topic)
    if not capture.size:
        raise CommandError(f'{printable(options.file)} is empty: there is nothing to play')
    return capture, b''


def _create_port(link: str | None) -> PtyPort:
    try:
        return PtyPort(link)
    except (OSError, WriteError) as error:
        raise CommandError(f'cannot create the port: {reason(error)}') from error


def _reopen_timeout(options: argparse.Namespace) -> float | None:
    if options.reopen_timeout is None and not options.loop:
        return REOPEN_TIMEOUT
    timeout: float | None = options.reopen_timeout
    return timeout


def _pieces(options: argparse.Namespace, capture: Capture | None, content: bytes,
            faults: Faults) -> Iterator[Piece]:
    """Return the pieces of a capture, or else of bytes, as they arrive over the cable."""
    spec = DEVICES[options.sensor]
    if capture and capture.timed:
        pieces = _timed_reads(capture)
    else:
        pieces = pace(_bounded_chunks(capture) if capture else [content],
                      Framer(spec.frame_format()), spec.frame_period)
    if not options.fault and options.latency_timer is None:
        return pieces
    cable = Cable(BAUD_RATE, options.latency_timer or AT_ONCE)
    return transmit(pieces, cable, faults, Framer(spec.frame_format()))


def _timed_reads(capture: Capture) -> Iterator[Piece]:
    """Yield the bytes of each read with its seconds since the first read."""
    log_clock, first = LogClock(), None
    for data, ros_ns, raw_ns, _ in capture.chunks():
        at = log_clock.observe(ros_ns or 0, raw_ns).raw_ns
        first = at if first is None else first
        yield (at - first) / NS_PER_S, data
    capture.notes.extend(log_clock.sentences())


def _bounded_chunks(capture: Capture) -> Iterator[bytes]:
    for chunk in capture.chunks():
        for start in range(0, len(chunk.data), PIECE):
            yield chunk.data[start:start + PIECE]


def _report(options: argparse.Namespace, played: int, faults: Faults, notes: list[str]) -> None:
    for note in notes:
        warn('replay', note)
    if options.json:
        print(json.dumps({'bytes': played, 'faults': dict(faults.counts), 'notes': notes}))
        return
    print(f'played {played:,} bytes', file=sys.stderr)
    print_counts(faults.counts.items(), sys.stderr)
