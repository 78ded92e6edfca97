# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The log of unexpected exceptions: faults of the driver itself, which it survives.

A fault in code that runs 200 times a second would fill the disk, so each kind is logged at most
every ten seconds. The user reads one sentence; the traceback is logged at level debug.
"""

from collections.abc import Callable
import threading
import time
import traceback

from bahrs_driver.process.printable import printable

LOG_PERIOD = 10.0           # s between log lines of the same kind
MOST_KINDS = 32             # further kinds are logged as one

Write = Callable[[str], object]


class FaultLog:
    """Counts and logs faults. Any thread may report one."""

    def __init__(self, write_error: Write, write_debug: Write) -> None:
        self.count = 0
        self.last = ''              # the latest fault, in one sentence
        self._write_error, self._write_debug = write_error, write_debug
        self._lock = threading.Lock()
        self._logged: dict[tuple[str, str], float] = {}

    def report(self, activity: str, error: BaseException) -> None:
        """Count an exception, and log the activity of the driver that failed and why."""
        sentence = f'{activity} failed: {type(error).__name__}: {_text(error)}'
        with self._lock:
            self.count += 1
            self.last = sentence
            due = self._is_due((activity, type(error).__name__))
        if due:
            self._write_error(f'{sentence}. This is a fault of bahrs_driver, which keeps '
                              'running: please report it')
            self._write_debug(''.join(traceback.format_exception(error)))

    def survive(self, activity: str, function: Callable[..., object], *arguments: object) -> None:
        """Call a function, and report its exception if it raises one."""
        try:
            function(*arguments)
        except Exception as error:
            self.report(activity, error)

    def _is_due(self, kind: tuple[str, str]) -> bool:
        now = time.monotonic()
        if kind not in self._logged and len(self._logged) >= MOST_KINDS:
            kind = ('', '')                 # the one for all further kinds
        due = now - self._logged.get(kind, -LOG_PERIOD) >= LOG_PERIOD
        if due:
            self._logged[kind] = now
        return due


def _text(error: BaseException) -> str:
    try:
        return printable(error)
    except Exception:           # its own __str__ fails
        return 'no description'
