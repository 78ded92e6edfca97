# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What several verbs need to read their arguments."""

import argparse
from collections.abc import Callable
import math
from typing import Any, TypeVar

from bahrs_driver.cli.errors import CommandError
from bahrs_driver.emulator.texts import number

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
    """Open a file, or raise CommandError."""
    try:
        return open(name, mode)
    except OSError as error:
        action = 'write' if 'w' in mode else 'read'
        raise CommandError(f'cannot {action} {name}: {error.strerror}') from error


def positive(text: str) -> float:
    """Return a number above 0, for argparse."""
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f'{text} is not more than 0')
    return value
