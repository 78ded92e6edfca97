# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
All tasks together: what goes out on /diagnostics, and when it must go out at once.

A change of level or message is reported at once, but never more than 20 times a second. Numbers
do not count: a message such as "Lost just now: 3 inertial" changes with each loss, and what is
new of it comes with the next periodic report.
"""

from collections.abc import Callable, Sequence
import re
import threading
import time

from bahrs_driver.diagnostics.names import status_name
from bahrs_driver.diagnostics.task import Task, Verdict
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

LEAST_INTERVAL = 0.05       # s from one report to the next
_NUMBER = re.compile(r'\d+([.,]\d+)*')


class Monitor:
    """Asks the tasks. It may be asked from any thread."""

    def __init__(self, tasks: Sequence[Task], node_label: str, hardware_id: str,
                 clock: Callable[[], float] = time.monotonic) -> None:
        """
        Take the tasks, the names of node and hardware, and a clock in seconds.

        Both names identify a status to those who collect them: after a change they would keep
        an entry that is never updated.
        """
        self._tasks = tasks
        self._node_label = node_label
        self.hardware_id = hardware_id
        self._clock = clock
        self._lock = threading.Lock()
        self._reported: list[tuple[bytes, str]] = []
        self._reported_at = -LEAST_INTERVAL

    def report_allowed(self) -> bool:
        """Return whether the latest report is LEAST_INTERVAL old."""
        with self._lock:
            return self._clock() - self._reported_at >= LEAST_INTERVAL

    def change_due(self) -> bool:
        """Return whether a level or message differs from the latest report, and may go out."""
        with self._lock:
            now = self._clock()
            return now - self._reported_at >= LEAST_INTERVAL and \
                [_without_numbers(*task.judge(now)) for task in self._tasks] != self._reported

    def verdicts(self) -> dict[str, Verdict]:
        """Return the present state of each task, by name."""
        with self._lock:
            now = self._clock()
            return {task.name: task.judge(now) for task in self._tasks}

    def statuses(self) -> list[DiagnosticStatus]:
        """Return the present state and values of each task."""
        with self._lock:
            now = self._clock()
            statuses = [self._status(task, now) for task in self._tasks]
            self._reported = [_without_numbers(status.level, status.message)
                              for status in statuses]
            self._reported_at = now
            return statuses

    def _status(self, task: Task, now: float) -> DiagnosticStatus:
        level, message = task.judge(now)
        values = [KeyValue(key=key, value=value) for key, value in task.values(now).items()]
        return DiagnosticStatus(level=level, name=status_name(self._node_label, task.name),
                                message=message, hardware_id=self.hardware_id, values=values)


def _without_numbers(level: bytes, message: str) -> tuple[bytes, str]:
    return level, _NUMBER.sub('#', message)
