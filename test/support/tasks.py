# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run a diagnostic task at a given time."""

from collections.abc import Mapping
import re

from bahrs_driver.diagnostics.task import DiagnosticTask, Status, Summary, Template


def summary_of(task: DiagnosticTask, now: float) -> Summary:
    """Return level and message, which are those of a message that the task declares."""
    status = task.run(Status(now))
    summary = Summary(status.level, status.message)
    assert any(summary.level == message.level and _pattern(message).fullmatch(summary.message)
               for message in task.messages), summary
    return summary


def values_of(task: DiagnosticTask, now: float) -> Mapping[str, str]:
    """Return the values."""
    return task.run(Status(now)).values()


def _pattern(message: Template) -> re.Pattern[str]:
    """Return a regular expression for the text, whatever the fields are."""
    parts = re.split(r'\{[^}]*\}', message.text)
    return re.compile('.*'.join(map(re.escape, parts)), re.DOTALL)
