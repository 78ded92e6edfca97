# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Opening what the user names, with a plain sentence where it cannot be."""

from collections.abc import Iterator
import contextlib
import sys
from typing import BinaryIO

from bahrs_driver.cli.arguments import opened

STANDARD_INPUT = '-'


@contextlib.contextmanager
def binary_input(name: str) -> Iterator[BinaryIO]:
    """Open a file for reading; "-" is standard input. CommandError if it cannot be."""
    if name == STANDARD_INPUT:
        yield sys.stdin.buffer
        return
    with opened(name, 'rb') as file:
        yield file
