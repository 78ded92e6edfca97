# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of a diagnostic task, after that of diagnostic_updater."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from diagnostic_msgs.msg import DiagnosticStatus

OK, WARN = DiagnosticStatus.OK, DiagnosticStatus.WARN
ERROR, STALE = DiagnosticStatus.ERROR, DiagnosticStatus.STALE
# Returns whether data has ceased, at a time of time.monotonic().
Staleness = Callable[[float], bool]


class Template(NamedTuple):
    """A message that a task can report: level, and text with the names of fields in braces."""

    level: bytes
    text: str
    cause: str = ''         # the cause in the table of the README; '' for no row


NO_DATA = Template(STALE, 'No data from the device')


class Summary(NamedTuple):
    """The level of a task, and its message for the user."""

    level: bytes
    message: str


class Status:
    """The report of a task at one time. Values are collected on request only."""

    __slots__ = ('now', 'report', '_collect')

    def __init__(self, now: float) -> None:
        self.now = now                      # s, of time.monotonic()
        self.report = Summary(STALE, '')
        self._collect: Callable[[float], Mapping[str, str]] | None = None

    def summary(self, template: Template, **fields: object) -> 'Status':
        """Set level and message; fields replace the names in braces."""
        level, text, _ = template
        self.report = Summary(level, text.format(**fields) if fields else text)
        return self

    def values_from(self, collect: Callable[[float], Mapping[str, str]]) -> None:
        """Set the function that returns the values at a time; formatting them takes a while."""
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
