# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What several verbs need to read their arguments."""

import argparse
from collections.abc import Callable
import math
from typing import Any, TypeVar

from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.virtual_serial.texts import number

Value = TypeVar('Value')


def checked(parse_text: Callable[[str], Value]) -> Callable[[str], Value]:
    """Return the same function for argparse, which shows only its own kind of error."""
    def parse_argument(text: str) -> Value:
        try:
            return parse_text(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error
    return parse_argument


def a_number(what: str, low: float = 0.0, high: float = math.inf) -> Callable[[str], float]:
    """Return what reads a number between two others."""
    return checked(lambda text: number(text, what, low, high))


def opened(name: str, mode: str) -> Any:
    """Open a file for reading; CommandError if that is not possible."""
    try:
        return open(name, mode)
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise CommandError(f'cannot read {printable(name)}: {reason}') from error


def positive(text: str) -> float:
    """Return a number above 0, for argparse."""
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f'{text} is not more than 0')
    return value
