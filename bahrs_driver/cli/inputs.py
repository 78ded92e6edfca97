# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Open the input files that the user names."""

from collections.abc import Iterator
import contextlib
import shlex
import sys
import termios
from typing import BinaryIO

from bahrs_driver.errors import CommandError
from bahrs_driver.process.argument_types import open_input
from bahrs_driver.process.printable import printable

STANDARD_INPUT = '-'
_LOCAL_MODES = 3        # index of these flags in what tcgetattr() returns


@contextlib.contextmanager
def binary_input(name: str) -> Iterator[BinaryIO]:
    """Open a file for reading; "-" is standard input. CommandError if that fails."""
    if name == STANDARD_INPUT:
        _refuse_line_mode(sys.stdin.buffer, 'standard input', 'name a file, or pipe one in')
        yield sys.stdin.buffer
        return
    with open_input(name, 'rb') as file:
        _refuse_line_mode(file, printable(name),
                          f'run "stty -F {shlex.quote(printable(name))} 115200 raw -echo" first')
        yield file


def _refuse_line_mode(file: BinaryIO, name: str, remedy: str) -> None:
    """Raise CommandError for a terminal in line mode, which does not deliver all bytes."""
    with contextlib.suppress(termios.error, OSError):       # no terminal
        if termios.tcgetattr(file.fileno())[_LOCAL_MODES] & termios.ICANON:
            raise CommandError(f'{name} is a terminal that is not in raw mode: {remedy}')
