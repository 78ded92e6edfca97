# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the progress bar."""

import io
import sys

from bahrs_driver.cli.progress import progress_bar


class Terminal(io.StringIO):
    """A stream that claims to be a terminal."""

    def isatty(self):
        """Return True."""
        return True


def shown(stream, monkeypatch):
    """Return the output of a bar."""
    monkeypatch.setattr(sys, 'stderr', stream)
    monkeypatch.setenv('TERM', 'xterm')
    with progress_bar() as progress:
        task = progress.add_task('reading', total=2)
        progress.update(task, completed=1)
    return stream.getvalue()


def test_nothing_is_written_to_a_file(monkeypatch):
    """Some versions of rich would write an empty line."""
    assert shown(io.StringIO(), monkeypatch) == ''


def test_a_terminal_shows_the_bar(monkeypatch):
    """It is shown during a task."""
    assert 'reading' in shown(Terminal(), monkeypatch)
