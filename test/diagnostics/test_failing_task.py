# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of tasks that raise exceptions."""

from bahrs_driver.diagnostics.task import ERROR, OK, Template
from bahrs_driver.diagnostics.updater import Updater
from bahrs_driver.process.fault_log import FaultLog
from hypothesis import given, strategies as st
import pytest


class Task:
    """A task that may fail."""

    def __init__(self, name, run_error=None, values_error=None):
        self.name = name
        self._errors = run_error, values_error

    def run(self, status):
        """Report OK, or raise."""
        status.values_from(self._values)
        if self._errors[0]:
            raise self._errors[0]
        return status.summary(Template(OK, 'fine'))

    def _values(self, now):
        if self._errors[1]:
            raise self._errors[1]
        return {'key': 'value'}


ERRORS = st.none() | st.sampled_from([ZeroDivisionError('x'), KeyError('y'), OverflowError()])


@pytest.mark.slow
@given(st.lists(st.tuples(ERRORS, ERRORS), max_size=5))
def test_a_failing_task_does_not_affect_the_others(errors):
    """A task that fails is an ERROR; values that cannot be collected are left out."""
    lines = []
    faults = FaultLog(lines.append, str)
    tasks = [Task(f'Task {index}', *pair) for index, pair in enumerate(errors)]
    updater = Updater(tasks, 'node', 'port', faults=faults)
    statuses = updater.statuses()
    assert [status.level for status in statuses] == [
        ERROR if run else OK for run, _ in errors]
    assert [len(status.values) for status in statuses] == [
        0 if values else 1 for _, values in errors]
    assert len(lines) == faults.count == sum(error is not None for pair in errors
                                             for error in pair)
    assert set(updater.summaries()) == {task.name for task in tasks}
