# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Log lasting errors of tasks: one line when an error begins, one when it ends.

The user who starts the driver watches the console, not /diagnostics. An error is logged after it
has lasted for MIN_DURATION seconds, and ends after as long a time without it. Otherwise a level
that changes all the time would fill the log.
"""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import ERROR, STALE, Summary

MIN_DURATION = 2.0          # s

Log = Callable[[str], None]


class ProblemLog:
    """
    Logs the errors of the tasks named in recoveries.

    error logs the message of a task; info logs the task's sentence in recoveries afterwards.
    """

    def __init__(self, recoveries: Mapping[str, str], error: Log, info: Log) -> None:
        self._recoveries = recoveries
        self._error = error
        self._info = info
        self._logged: set[str] = set()              # tasks whose error is in the log
        self._changed_at: dict[str, float] = {}     # since when a task differs from the log

    def check(self, summaries: Mapping[str, Summary], now: float) -> None:
        """
        Check the summaries at a time of time.monotonic(); call it a few times a second.

        A task without a summary, or a stale one, is neither in error nor recovered.
        """
        for name in self._recoveries:
            summary = summaries.get(name)
            is_logged = name in self._logged
            if summary is None or summary.level == STALE \
                    or (summary.level == ERROR) == is_logged:
                self._changed_at.pop(name, None)
            elif now - self._changed_at.setdefault(name, now) >= MIN_DURATION:
                del self._changed_at[name]
                if is_logged:
                    self._logged.remove(name)
                    self._info(self._recoveries[name])
                else:
                    self._logged.add(name)
                    self._error(summary.message)
