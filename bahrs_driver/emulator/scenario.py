# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Scenarios: control commands with their times.

Each line has the seconds since the start and a command as on the control line. Empty lines and
comments, which begin with #, are ignored.

    12.5  integrity roll risk
    20    integrity roll safe
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from bahrs_driver.emulator.control import validate
from bahrs_driver.errors import ControlError, ScenarioError


class TimedCommand(NamedTuple):
    """A command, and the time to execute it in seconds since the start."""

    time: float
    line: str


def parse(lines: Iterable[str]) -> list[TimedCommand]:
    """Parse a scenario and sort its commands by time; ScenarioError if a line is invalid."""
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
        yield TimedCommand(time, _validated(words[1].strip(), index))


def _validated(command: str, index: int) -> str:
    try:
        validate(command)
    except ControlError as error:
        raise ScenarioError(f'line {index}: {error}') from error
    return command
