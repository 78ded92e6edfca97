# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The result of a check, with the command that corrects a problem."""

from enum import Enum
from typing import NamedTuple


class Level(Enum):
    """How much a result matters."""

    OK = 'ok'
    ADVICE = 'advice'       # it works; it would be better otherwise
    PROBLEM = 'problem'     # it does not work


class Prevents(Enum):
    """Which later checks a result makes impossible."""

    NOTHING = 0
    LISTENING = 1           # the port cannot be opened, or must not be
    ROS = 2                 # ROS would not start


class CheckResult(NamedTuple):
    """The result of one check."""

    check: str              # the name of the check, one or two words
    level: Level
    message: str            # the state, in a sentence
    command: str = ''       # the command that corrects it; empty if there is nothing to correct
    prevents: Prevents = Prevents.NOTHING

    def to_json(self) -> dict[str, str]:
        """Return the fields that users see as plain values."""
        return {'check': self.check, 'level': self.level.value, 'message': self.message,
                'command': self.command}


def good(check: str, message: str, prevents: Prevents = Prevents.NOTHING) -> CheckResult:
    """Return the result that something is as it should be."""
    return CheckResult(check, Level.OK, message, '', prevents)


def advice(check: str, message: str, command: str = '') -> CheckResult:
    """Return the result that something would be better otherwise."""
    return CheckResult(check, Level.ADVICE, message, command)


def problem(check: str, message: str, command: str,
            prevents: Prevents = Prevents.NOTHING) -> CheckResult:
    """Return the result that something does not work."""
    return CheckResult(check, Level.PROBLEM, message, command, prevents)
