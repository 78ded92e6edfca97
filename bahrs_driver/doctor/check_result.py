# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The result of a check, with the command that corrects a problem."""

from enum import Enum
from typing import NamedTuple


class Level(Enum):
    """The severity of a result."""

    OK = 'ok'
    ADVICE = 'advice'       # it works and could be better
    PROBLEM = 'problem'     # it does not work


class Prevents(Enum):
    """The later checks that a result makes impossible."""

    NOTHING = 0
    LISTENING = 1           # the port cannot be opened, or must not be
    ROS = 2                 # ROS would not start


class CheckResult(NamedTuple):
    """The result of one check."""

    check: str              # the name of the check, one or two words
    level: Level
    message: str            # the state in a sentence
    command: str = ''       # the command that corrects it; empty if there is nothing to correct
    prevents: Prevents = Prevents.NOTHING

    def to_json(self) -> dict[str, str]:
        """Return the fields that users see as plain values."""
        return {'check': self.check, 'level': self.level.value, 'message': self.message,
                'command': self.command}


def ok(check: str, message: str, prevents: Prevents = Prevents.NOTHING) -> CheckResult:
    """Return a result without a problem."""
    return CheckResult(check, Level.OK, message, '', prevents)


def advice(check: str, message: str, command: str = '') -> CheckResult:
    """Return a result with advice."""
    return CheckResult(check, Level.ADVICE, message, command)


def problem(check: str, message: str, command: str,
            prevents: Prevents = Prevents.NOTHING) -> CheckResult:
    """Return a result with a problem, and the command that corrects it."""
    return CheckResult(check, Level.PROBLEM, message, command, prevents)
