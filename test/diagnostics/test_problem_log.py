# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the log lines for lasting errors."""

from bahrs_driver.diagnostics.problem_log import MIN_DURATION, ProblemLog
from bahrs_driver.diagnostics.task import ERROR, OK, STALE, Summary, WARN
from hypothesis import given, strategies as st

LEVELS = {'e': ERROR, 'o': OK, 'w': WARN, 's': STALE, '-': None}


def logged(levels, step=0.5):
    """Return the log lines for a sequence of levels, one letter every step seconds."""
    lines = []
    log = ProblemLog({'Framing': 'intact'}, lambda text: lines.append(f'error {text}'),
                     lambda text: lines.append(f'info {text}'))
    for index, letter in enumerate(levels):
        level = LEVELS[letter]
        log.check({} if level is None else {'Framing': Summary(level, 'no frames')},
                  100.0 + step * index)
    return lines


def test_begin_and_end_of_an_error_are_logged_once():
    """The duration of the error does not matter."""
    assert logged('oooooo' + 'e' * 100 + 'o' * 100) == ['error no frames', 'info intact']
    assert logged('e' * 9 + 'w' * 9 + 'e' * 9) == [
        'error no frames', 'info intact', 'error no frames']


def test_short_errors_are_not_logged():
    """A stream may begin with errors, or change its level all the time."""
    assert logged('eooo' * 50) == []
    assert logged('e' * 9 + 'oe' * 50) == ['error no frames']


def test_no_data_is_neither_an_error_nor_its_end():
    """The same holds for a task without a summary, whose port is closed."""
    assert logged('s' * 50) == [] and logged('-' * 50) == []
    assert logged('e' * 9 + 's' * 50 + '-' * 50) == ['error no frames']
    assert logged('eee' + 's' * 9 + 'eee') == []


@given(st.text('eows-', max_size=300), st.sampled_from((0.05, 0.1, 0.5)))
def test_lines_alternate_and_are_limited(levels, step):
    """For any levels, error and end alternate, with at least MIN_DURATION between them."""
    lines = logged(levels, step)
    assert lines[::2] == ['error no frames'] * len(lines[::2])
    assert lines[1::2] == ['info intact'] * len(lines[1::2])
    assert len(lines) <= len(levels) * step / MIN_DURATION
