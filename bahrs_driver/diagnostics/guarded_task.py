# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A task of the diagnostics whose faults cost the others nothing."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import ERROR, Task, Verdict
from bahrs_driver.process.fault_log import FaultLog


class GuardedTask:
    """Shows a task, or that it cannot be evaluated: the other tasks are reported in any case."""

    def __init__(self, task: Task, faults: FaultLog) -> None:
        self.name = task.name
        self._task = task
        self._faults = faults

    def judge(self, now: float) -> Verdict:
        """Return the present state of the task."""
        try:
            return self._task.judge(now)
        except Exception as error:
            self._faults.report(f'evaluating the diagnostics of {self.name}', error)
            return Verdict(ERROR, 'This check failed, its state is unknown: please report the '
                                  'fault that the log shows')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the values of the task, none if they cannot be determined."""
        try:
            return self._task.values(now)
        except Exception as error:
            self._faults.report(f'collecting the values of {self.name}', error)
            return {}
