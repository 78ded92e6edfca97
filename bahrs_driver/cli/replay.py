# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""`bahrs replay`: a recorded stream of bytes, on a port, as the device sent it."""

import argparse
import sys
import time

from bahrs_driver.cli.errors import CommandError
from bahrs_driver.cli.files import binary_input
from bahrs_driver.emulator.pacing import paced
from bahrs_driver.emulator.pty_port import PtyPort

_EXAMPLES = """examples:
  bahrs replay flight.bin --link /tmp/bahrs
  ros2 run bahrs_driver driver_node --ros-args -p port:=/tmp/bahrs
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Describe the verb and its options."""
    parser.description = (
        'Make a serial port (a pseudo-terminal), print its path, wait until somebody opens\n'
        'it, and play the bytes of a BAHRS at the rates of the device.')
    parser.epilog = _EXAMPLES
    parser.add_argument('file', help='file of bytes as the device sent them; - is standard input')
    parser.add_argument('--link', metavar='PATH', help='make a symbolic link to the port')
    parser.add_argument('--rate', type=_positive, default=1.0, metavar='FACTOR',
                        help='how many times faster than the device (default: %(default)s)')
    parser.add_argument('--loop', action='store_true', help='begin again at the end')
    parser.add_argument('--settle', type=float, default=0.5, metavar='SECONDS',
                        help='time given to whoever opens the port before the first byte '
                             '(default: %(default)s)')


def run(options: argparse.Namespace) -> int:
    """Play the file; Ctrl-C ends it."""
    with binary_input(options.file) as file:
        pieces = list(paced(file.read()))
    try:
        port = PtyPort(options.link)
    except OSError as error:
        raise CommandError(f'cannot make the port: {error}') from error
    with port:
        print(port.name, flush=True)
        port.wait_until_open()
        time.sleep(options.settle)
        while True:
            _play(pieces, port, options.rate)
            if not options.loop:
                break
        # What is still unread would vanish with the port.
        time.sleep(options.settle)
    print(f'played {sum(len(data) for _, data in pieces):,} bytes', file=sys.stderr)
    return 0


def _play(pieces: list[tuple[float, bytes]], port: PtyPort, rate: float) -> None:
    start = time.monotonic()
    for due, data in pieces:
        ahead = start + due / rate - time.monotonic()
        if ahead > 0:
            time.sleep(ahead)
        port.write(data)


def _positive(text: str) -> float:
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f'{text} is not more than 0')
    return value
