# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Types of command-line arguments, for argparse."""

import argparse
from collections.abc import Callable
import math
from typing import Any, TypeVar

from bahrs_driver.errors import CommandError
from bahrs_driver.process.printable import printable
from bahrs_driver.process.text_values import number

Value = TypeVar('Value')


def argument_type(parse_text: Callable[[str], Value]) -> Callable[[str], Value]:
    """Return a parser of text that raises the error which argparse shows."""
    def parse_argument(text: str) -> Value:
        try:
            return parse_text(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error
    return parse_argument


def bounded_float(what: str, low: float = 0.0, high: float = math.inf) -> Callable[[str], float]:
    """Return a parser of numbers from low to high."""
    return argument_type(lambda text: number(text, what, low, high))


def open_input(name: str, mode: str) -> Any:
    """Open a file for reading; raise CommandError if it cannot be opened."""
    try:
        return open(name, mode)
    except (OSError, ValueError) as error:
        reason = getattr(error, 'strerror', None) or error
        raise CommandError(f'cannot read {printable(name)}: {reason}') from error


def positive_float(text: str) -> float:
    """Parse a number above 0."""
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f'{text} is not more than 0')
    return value
