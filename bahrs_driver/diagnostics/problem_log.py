# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Lasting errors of tasks as lines of the log: one when an error begins, one when it is over.

The user who starts the driver watches the console, not /diagnostics. An error is logged once it
has lasted for LASTING seconds, and is over once there has been none for as long, so that a line at
the limit does not fill the log.
"""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, STALE, Verdict

LASTING = 2.0           # s

Log = Callable[[str], None]


class ProblemLog:
    """Logs the errors of several tasks."""

    def __init__(self, recoveries: Mapping[str, str], error: Log, info: Log) -> None:
        """
        Watch the tasks named in recoveries.

        error logs the message of a task; info logs the task's sentence in recoveries afterwards.
        """
        self._recoveries = recoveries
        self._error = error
        self._info = info
        self._logged: set[str] = set()          # tasks whose error is in the log
        self._since: dict[str, float] = {}      # and since when they are otherwise

    def check(self, verdicts: Mapping[str, Verdict], now: float) -> None:
        """
        Take the verdicts at a time of time.monotonic(); call it a few times a second.

        A task without a verdict, or a stale one, is neither in error nor right again.
        """
        for name in self._recoveries:
            verdict = verdicts.get(name)
            if verdict is None or verdict.level == STALE \
                    or (verdict.level == ERROR) == (name in self._logged):
                self._since.pop(name, None)
            elif now - self._since.setdefault(name, now) >= LASTING:
                del self._since[name]
                self._log(name, verdict.message)

    def _log(self, name: str, message: str) -> None:
        if name in self._logged:
            self._logged.remove(name)
            self._info(self._recoveries[name])
        else:
            self._logged.add(name)
            self._error(message)
