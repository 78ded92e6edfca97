# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of a diagnostic task, after that of diagnostic_updater."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from bahrs_driver.convert import values

OK, WARN, ERROR, STALE = values.OK, values.WARN, values.ERROR, values.STALE
# Returns whether the stream has stopped, at a time of time.monotonic().
Staleness = Callable[[float], bool]


class Template(NamedTuple):
    """A message that a task can report."""

    level: bytes
    text: str               # with the names of fields in braces
    cause: str = ''         # for the table in the README; messages without one are not listed


NO_DATA = Template(STALE, 'No data from the device')


class Summary(NamedTuple):
    """The level of a task, and its message for the user."""

    level: bytes
    message: str


class Status:
    """What a task fills in. Its values are collected on request only."""

    __slots__ = ('now', 'level', 'message', '_collect')

    def __init__(self, now: float) -> None:
        self.now = now                      # s, of time.monotonic()
        self.level, self.message = STALE, ''
        self._collect: Callable[[float], Mapping[str, str]] | None = None

    def summary(self, template: Template, **fields: object) -> 'Status':
        """Set level and message; fields replace the names in braces."""
        self.level = template.level
        self.message = template.text.format(**fields) if fields else template.text
        return self

    def values_from(self, collect: Callable[[float], Mapping[str, str]]) -> None:
        """Set the function that formats the values, which is slow, at a given time."""
        self._collect = collect

    def values(self) -> Mapping[str, str]:
        """Return the values."""
        return self._collect(self.now) if self._collect else {}


class DiagnosticTask(Protocol):
    """One status on /diagnostics. Times are those of time.monotonic(), in seconds."""

    name: str

    @property
    def messages(self) -> tuple[Template, ...]:
        """Every message that the task can report."""

    def run(self, status: Status) -> Status:
        """Set level and message, fast enough to be called after every read."""


def seconds_ago(time: float | None, now: float) -> str:
    """Return the age of an event in seconds, as text."""
    return 'never' if time is None else f'{now - time:.1f}'
