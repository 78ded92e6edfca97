# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a task of the diagnostics is."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

from diagnostic_msgs.msg import DiagnosticStatus

OK, WARN = DiagnosticStatus.OK, DiagnosticStatus.WARN
ERROR, STALE = DiagnosticStatus.ERROR, DiagnosticStatus.STALE
# Returns whether data has ceased, at a time of time.monotonic().
Staleness = Callable[[float], bool]
NO_DATA = 'No data from the device'


class Verdict(NamedTuple):
    """How it is, and what to do about it."""

    level: bytes
    message: str


class Task(Protocol):
    """One thing that is watched. Times are those of time.monotonic(), in seconds."""

    name: str

    def judge(self, now: float) -> Verdict:
        """Return the present state."""

    def values(self, now: float) -> Mapping[str, str]:
        """Return what the state was judged by."""


def ago(moment: float | None, now: float) -> str:
    """Return how many seconds ago something was, as text."""
    return 'never' if moment is None else f'{now - moment:.1f}'
