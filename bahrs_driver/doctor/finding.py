# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What was found, and the command that mends it."""

from enum import Enum
from typing import NamedTuple


class Level(Enum):
    """How much it matters."""

    OK = 'ok'
    ADVICE = 'advice'       # it works; it would be better so
    PROBLEM = 'problem'     # it does not work


class Finding(NamedTuple):
    """One thing that was looked at."""

    check: str              # what was looked at, in a word or two
    level: Level
    message: str            # how it is, in a sentence
    command: str = ''       # what to type to fix it; empty if there is nothing to fix


def good(check: str, message: str) -> Finding:
    """Return that something is as it should be."""
    return Finding(check, Level.OK, message)


def advice(check: str, message: str, command: str = '') -> Finding:
    """Return that something would be better otherwise."""
    return Finding(check, Level.ADVICE, message, command)


def problem(check: str, message: str, command: str) -> Finding:
    """Return that something does not work so."""
    return Finding(check, Level.PROBLEM, message, command)
