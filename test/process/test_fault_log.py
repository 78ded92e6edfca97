# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Faults are counted, and logged in one printable sentence each, not at line rate."""

from bahrs_driver.process.fault_log import FaultLog, MOST_KINDS
from hypothesis import given, strategies as st

ERRORS = st.one_of(
    st.builds(ValueError, st.text()), st.builds(OSError, st.integers(), st.text()),
    st.just(SystemExit(3)), st.builds(UnicodeDecodeError, st.just('utf-8'), st.binary(
        min_size=1), st.just(0), st.just(1), st.text()))


class Unspeakable(Exception):
    """An exception that cannot be described."""

    def __str__(self):
        """Fail."""
        raise TypeError


@given(ERRORS)
def test_one_printable_line(error):
    """For any exception."""
    lines, traces = [], []
    log = FaultLog(lines.append, traces.append)
    log.report('a callback', error)
    assert len(lines) == len(traces) == 1 and lines[0].isprintable()
    assert lines[0].startswith(f'a callback failed: {type(error).__name__}: ')


def test_a_function_that_fails_is_survived():
    """The function receives its arguments."""
    lines, called = [], []
    log = FaultLog(lines.append, str)
    log.survive('working', called.append, 3)
    log.survive('working', int, 'x')
    assert called == [3] and log.count == 1 and lines[0].startswith('working failed: ValueError')


def test_not_at_line_rate():
    """The first of a kind is logged, all are counted."""
    lines = []
    log = FaultLog(lines.append, str)
    for _ in range(1000):
        log.report('publishing', ValueError('x'))
        log.report('publishing', Unspeakable())
    assert (len(lines), log.count) == (2, 2000)
    assert log.last == 'publishing failed: Unspeakable: no description'


def test_kinds_are_bounded():
    """An activity per message would grow the table, and the log, without end."""
    lines = []
    log = FaultLog(lines.append, str)
    for number in range(10 * MOST_KINDS):
        log.report(f'message {number}', ValueError())
    assert len(lines) == MOST_KINDS + 1
