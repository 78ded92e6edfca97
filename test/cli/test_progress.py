# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the bar of progress: on a terminal only."""

import io
import sys

from bahrs_driver.cli.progress import progress_bar


class Terminal(io.StringIO):
    """A standard error that claims to be a terminal."""

    def isatty(self):
        """Say so."""
        return True


def shown(stream, monkeypatch):
    """Return what a bar writes."""
    monkeypatch.setattr(sys, 'stderr', stream)
    monkeypatch.setenv('TERM', 'xterm')
    with progress_bar() as progress:
        task = progress.add_task('reading', total=2)
        progress.update(task, completed=1)
    return stream.getvalue()


def test_nothing_is_written_into_a_file(monkeypatch):
    """Not even an empty line, which every version of rich has its own mind about."""
    assert shown(io.StringIO(), monkeypatch) == ''


def test_a_terminal_shows_it(monkeypatch):
    """While something goes on."""
    assert 'reading' in shown(Terminal(), monkeypatch)
