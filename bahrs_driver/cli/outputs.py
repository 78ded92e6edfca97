# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Open the output files that the user names.

One rule for all verbs: an output is a regular file, complete or absent, and replaces another one
only with --force. "-" and /dev/stdout are standard output, /dev/null discards; no other device,
FIFO or socket is written.
"""

import argparse
from collections.abc import Iterator
import contextlib
import os
import sys
from typing import TextIO

from bahrs_driver.emulator.runner import ByteSink
from bahrs_driver.errors import CommandError, TargetExists
from bahrs_driver.files.atomic_file import atomic_file
from bahrs_driver.files.guard import guard
from bahrs_driver.files.live_file import LiveFile

STANDARD_OUTPUT = ('-', '/dev/stdout')


def add_force(parser: argparse.ArgumentParser) -> None:
    """Add the option --force."""
    parser.add_argument('--force', action='store_true',
                        help='replace an existing file (default: refuse)')


def is_standard_output(name: str) -> bool:
    """Return whether a name means standard output."""
    return name in STANDARD_OUTPUT


def same_output(one: str, other: str | None) -> bool:
    """Return whether two outputs are the same file; the second may be None."""
    if other is None or os.devnull in (one, other):
        return False
    if is_standard_output(one) or is_standard_output(other):
        return is_standard_output(one) and is_standard_output(other)
    with guard(one):
        return os.path.realpath(one) == os.path.realpath(other)


@contextlib.contextmanager
def _suggest_force() -> Iterator[None]:
    """Add the option --force to the error for an existing file."""
    try:
        yield
    except TargetExists as error:
        raise CommandError(f'{error}, or replace it with --force') from error


@contextlib.contextmanager
def output_file(name: str, force: bool) -> Iterator[ByteSink]:
    """
    Yield an output for bytes; the file appears when the block ends, unless it raises.

    WriteError or CommandError, before the block if possible, if the file cannot be written.
    """
    with _suggest_force():
        if is_standard_output(name):
            yield sys.stdout.buffer
        elif name == os.devnull:
            with open(name, 'wb') as sink:
                yield sink
        else:
            with atomic_file(name, force) as file:
                yield file
                file.commit()


@contextlib.contextmanager
def live_output(name: str, force: bool) -> Iterator[TextIO | LiveFile]:
    """Yield an output for text that other programs read during the block."""
    with _suggest_force():
        if is_standard_output(name):
            yield sys.stdout
        elif name == os.devnull:
            with open(name, 'w') as sink:
                yield sink
        else:
            with contextlib.closing(LiveFile(name, force)) as file:
                yield file
