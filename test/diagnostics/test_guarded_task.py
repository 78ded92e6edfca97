# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A task that fails is shown as failed, and the others as they are."""

from bahrs_driver.diagnostics.guarded_task import GuardedTask
from bahrs_driver.diagnostics.monitor import Monitor
from bahrs_driver.diagnostics.task import ERROR, OK, Verdict
from bahrs_driver.process.fault_log import FaultLog
from hypothesis import given, strategies as st


class Task:
    """A task that may fail."""

    def __init__(self, name, judge_error=None, values_error=None):
        """Raise these, if they are given."""
        self.name = name
        self._errors = judge_error, values_error

    def judge(self, now):
        """Return the state."""
        if self._errors[0]:
            raise self._errors[0]
        return Verdict(OK, 'fine')

    def values(self, now):
        """Return the values."""
        if self._errors[1]:
            raise self._errors[1]
        return {'key': 'value'}


ERRORS = st.none() | st.sampled_from([ZeroDivisionError('x'), KeyError('y'), OverflowError()])


@given(st.lists(st.tuples(ERRORS, ERRORS), max_size=5))
def test_every_task_is_reported(errors):
    """Whichever of them fail, in either part."""
    lines = []
    faults = FaultLog(lines.append, str)
    tasks = [Task(f'Task {index}', *pair) for index, pair in enumerate(errors)]
    monitor = Monitor([GuardedTask(task, faults) for task in tasks], 'node', 'port')
    statuses = monitor.statuses()
    assert [status.level for status in statuses] == [
        ERROR if judge else OK for judge, _ in errors]
    assert [len(status.values) for status in statuses] == [
        0 if values else 1 for _, values in errors]
    assert len(lines) == faults.count == sum(error is not None for pair in errors
                                             for error in pair)
    assert set(monitor.verdicts()) == {task.name for task in tasks}
