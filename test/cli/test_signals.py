# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the signals that end a verb."""

import contextlib
import os
from pathlib import Path
import signal

from bahrs_driver.cli.signals import signals_deferred
from bahrs_driver.process.shutdown_event import HANDLED_SIGNALS, handled_signals
import pytest
from support.processes import command, Process, wait_for


@pytest.mark.parametrize(('before', 'kinds'), [
    (signal.SIG_DFL, [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]),
    (signal.SIG_IGN, [signal.SIGINT, signal.SIGTERM]),
])
def test_an_ignored_hang_up_stays_ignored(before, kinds):
    """The command nohup relies on it."""
    own = signal.signal(signal.SIGHUP, before)
    try:
        assert handled_signals() == kinds
    finally:
        signal.signal(signal.SIGHUP, own)


# Those that run until they are ended.
WORDS = {'decode': ['--format', 'jsonl', '-'], 'emulate': ['--link', 'port'],
         'monitor': ['--json'], 'record': ['-o', 'bag'],
         'replay': ['flight.bin', '--link', 'port']}


@contextlib.contextmanager
def ignoring(number, verb):
    """Run a verb with an ignored signal, as a script or nohup does."""
    name = signal.Signals(number).name.removeprefix('SIG')
    process = Process(['sh', '-c', f'trap "" {name}; exec "$@"', 'sh',
                       *command('bahrs', verb, *WORDS[verb])])
    try:
        yield process
    finally:
        if process.alive:
            process.end(signal.SIGKILL)


def signals(process, kind):
    """Return the signals that a process handles (SigCgt) or ignores (SigIgn)."""
    line = next(line for line in Path(f'/proc/{process.pid}/status').read_text().splitlines()
                if line.startswith(kind))
    bits = int(line.split()[1], 16)
    return {number for number in signal.Signals if bits >> number - 1 & 1}


@pytest.fixture
def in_folder(tmp_path, monkeypatch):
    """Change to a directory with a file of raw bytes."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'flight.bin').write_bytes(bytes(1000))


@pytest.mark.parametrize('verb', WORDS)
def test_a_signal_ends_a_background_process_of_a_script(in_folder, verb):
    """The shell starts it with the signal ignored."""
    with ignoring(signal.SIGINT, verb) as process:
        assert wait_for(lambda: signal.SIGINT in signals(process, 'SigCgt'))
        assert process.end(signal.SIGINT) >= 0
        assert 'Traceback' not in process.text


@pytest.mark.parametrize('verb', WORDS)
def test_a_hang_up_does_not_end_a_process_of_nohup(in_folder, verb):
    """Another signal ends it."""
    with ignoring(signal.SIGHUP, verb) as process:
        assert wait_for(lambda: signal.SIGTERM in signals(process, 'SigCgt'))
        assert signal.SIGHUP in signals(process, 'SigIgn')
        os.kill(process.pid, signal.SIGHUP)
        assert process.end(signal.SIGTERM) >= 0
        assert 'Traceback' not in process.text


def test_an_import_cannot_swallow_a_signal():
    """It takes effect at the end of the block, and at once after it."""
    before = {kind: signal.getsignal(kind) for kind in HANDLED_SIGNALS}
    finished = []
    try:
        with pytest.raises(KeyboardInterrupt):
            with signals_deferred():
                signal.raise_signal(signal.SIGINT)
                finished.append(True)
        assert finished
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)
