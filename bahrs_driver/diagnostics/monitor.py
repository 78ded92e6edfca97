# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""All tasks together: what goes out on /diagnostics, and when it must go out at once."""

from collections.abc import Callable, Sequence
import threading
import time

from bahrs_driver.diagnostics.task import Task, Verdict
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue


class Monitor:
    """Asks the tasks. It may be asked from any thread."""

    def __init__(self, tasks: Sequence[Task], prefix: str, hardware_id: Callable[[], str],
                 clock: Callable[[], float] = time.monotonic) -> None:
        """Take the tasks, what their names begin with, and a clock in seconds."""
        self._tasks = tasks
        self._prefix = prefix
        self._hardware_id = hardware_id
        self._clock = clock
        self._lock = threading.Lock()
        self._told: list[bytes] = []

    @property
    def hardware_id(self) -> str:
        """Name of the device."""
        return self._hardware_id()

    def level_changed(self) -> bool:
        """Return whether a task has another level than when the statuses were last asked for."""
        with self._lock:
            now = self._clock()
            return [task.judge(now).level for task in self._tasks] != self._told

    def verdicts(self) -> dict[str, Verdict]:
        """Return the present state of each task, by name."""
        with self._lock:
            now = self._clock()
            return {task.name: task.judge(now) for task in self._tasks}

    def statuses(self) -> list[DiagnosticStatus]:
        """Return the present state and values of each task."""
        with self._lock:
            now, hardware_id = self._clock(), self._hardware_id()
            statuses = [self._status(task, now, hardware_id) for task in self._tasks]
            self._told = [status.level for status in statuses]
            return statuses

    def _status(self, task: Task, now: float, hardware_id: str) -> DiagnosticStatus:
        level, message = task.judge(now)
        values = [KeyValue(key=key, value=value) for key, value in task.values(now).items()]
        return DiagnosticStatus(level=level, name=f'{self._prefix}: {task.name}', message=message,
                                hardware_id=hardware_id, values=values)
