# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Commands that happen by themselves, at their time.

A scenario is a text with a line for each: seconds since the start, then a command as for the
control line. Empty lines and what follows a # mean nothing.

    12.5  integrity roll risk
    20    integrity roll safe
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from bahrs_driver.emulator.control import check
from bahrs_driver.errors import ControlError, ScenarioError


class TimedCommand(NamedTuple):
    """A command and when to carry it out, in seconds since the start."""

    time: float
    line: str


def parse(lines: Iterable[str]) -> list[TimedCommand]:
    """Return the commands of a scenario by time; ScenarioError if a line is wrong."""
    return sorted(_parse(lines), key=lambda command: command.time)


def _parse(lines: Iterable[str]) -> Iterator[TimedCommand]:
    for index, line in enumerate(lines, start=1):
        words = line.split('#')[0].split(maxsplit=1)
        if not words:
            continue
        try:
            time = float(words[0])
        except ValueError:
            time = -1.0
        if not 0 <= time < float('inf') or len(words) < 2:
            raise ScenarioError(f'line {index} is {line.strip()!r}: it must be seconds and a '
                                'command, such as "12.5 integrity roll risk"')
        yield TimedCommand(time, _checked(words[1].strip(), index))


def _checked(command: str, index: int) -> str:
    try:
        check(command)
    except ControlError as error:
        raise ScenarioError(f'line {index}: {error}') from error
    return command
