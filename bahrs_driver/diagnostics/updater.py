# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Run all tasks, and detect changes that must be published at once.

A change of level or message is published at once, but at most 20 times a second. A change of
numbers alone, as in "Lost just now: 3 inertial", can wait for the next periodic report.
"""

from collections.abc import Callable, Mapping, Sequence
import re
import threading
import time

from bahrs_driver.convert.values import DiagnosticStatus, KeyValue
from bahrs_driver.diagnostics.names import status_name
from bahrs_driver.diagnostics.task import DiagnosticTask, ERROR, Status, Summary, Template
from bahrs_driver.process.fault_log import FaultLog

MIN_INTERVAL = 0.05         # s from one report to the next
TASK_FAILED = Template(ERROR, 'This check failed and its state is unknown: please report the '
                              'fault in the log')
_NUMBER = re.compile(r'\d+([.,]\d+)*')


class Updater:
    """
    Runs tasks, from any thread. A task that raises does not affect the others.

    node_label and hardware_id identify a status and must not change: subscribers would keep the
    old entry. Without a fault log, exceptions of the tasks are passed on.
    """

    def __init__(self, tasks: Sequence[DiagnosticTask], node_label: str, hardware_id: str,
                 clock: Callable[[], float] = time.monotonic,
                 faults: FaultLog | None = None) -> None:
        self._tasks = tasks
        self._node_label = node_label
        self.hardware_id = hardware_id
        self._clock = clock
        self._faults = faults
        self._lock = threading.Lock()
        self._reported: list[Summary] = []      # without numbers
        self._change_due = True
        self.latest: Mapping[str, Summary] = {}     # by task, when the tasks ran last
        self._reported_at = self._evaluated_at = -MIN_INTERVAL

    def report_allowed(self) -> bool:
        """Return whether the latest report is at least MIN_INTERVAL old."""
        with self._lock:
            return self._clock() - self._reported_at >= MIN_INTERVAL

    def change_due(self) -> bool:
        """
        Return whether a level or message differs from the latest report.

        The tasks run 20 times a second at most, however often this is called.
        """
        if self._clock() - self._evaluated_at < MIN_INTERVAL:
            return False                # as at most reads, without the lock
        with self._lock:
            now = self._clock()
            if now - self._evaluated_at < MIN_INTERVAL:
                return False            # another thread has just done it
            self._evaluated_at = now
            before, self.latest = self.latest, _summaries(self._run_all(now))
            if self.latest != before:
                self._change_due = _without_numbers(self.latest) != self._reported
            return self._change_due

    def summaries(self) -> Mapping[str, Summary]:
        """Return the present level and message of each task, by its name."""
        with self._lock:
            return _summaries(self._run_all(self._clock()))

    def statuses(self) -> tuple[DiagnosticStatus, ...]:
        """Return the present level, message and values of each task."""
        with self._lock:
            now = self._clock()
            statuses = self._run_all(now)
            self.latest = _summaries(statuses)
            self._reported, self._change_due = _without_numbers(self.latest), False
            self._reported_at = self._evaluated_at = now
            return tuple(DiagnosticStatus(
                status.level, status_name(self._node_label, name), status.message,
                self.hardware_id, self._values(name, status)) for name, status in statuses.items())

    def _run_all(self, now: float) -> dict[str, Status]:
        return {task.name: self._run(task, now) for task in self._tasks}

    def _run(self, task: DiagnosticTask, now: float) -> Status:
        status = Status(now)
        try:
            return task.run(status)
        except Exception as error:
            if self._faults is None:
                raise
            self._faults.report(f'evaluating the diagnostics of {task.name}', error)
            return status.summary(TASK_FAILED)

    def _values(self, name: str, status: Status) -> tuple[KeyValue, ...]:
        try:
            return tuple(KeyValue(*pair) for pair in status.values().items())
        except Exception as error:
            if self._faults is None:
                raise
            self._faults.report(f'collecting the values of {name}', error)
            return ()


def _summaries(statuses: Mapping[str, Status]) -> dict[str, Summary]:
    return {name: Summary(status.level, status.message) for name, status in statuses.items()}


def _without_numbers(summaries: Mapping[str, Summary]) -> list[Summary]:
    return [Summary(level, _NUMBER.sub('#', message)) for level, message in summaries.values()]
