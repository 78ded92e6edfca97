# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Opening what the user names, with a plain sentence where it cannot be."""

from collections.abc import Iterator
import contextlib
import sys
from typing import BinaryIO

from bahrs_driver.cli.errors import CommandError

STANDARD_INPUT = '-'


@contextlib.contextmanager
def binary_input(name: str) -> Iterator[BinaryIO]:
    """Open a file for reading; "-" is standard input. CommandError if it cannot be."""
    if name == STANDARD_INPUT:
        yield sys.stdin.buffer
        return
    try:
        file = open(name, 'rb')
    except OSError as error:
        raise CommandError(f'cannot read {name}: {error.strerror}') from error
    with file:
        yield file
