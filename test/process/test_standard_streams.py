# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of commands whose standard streams are closed, full, or no longer read."""

import os
import shlex
import shutil
import subprocess

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.emulated import emissions, make_device
from support.processes import command, listening, PATIENCE

VERBS = {
    'decode': ('decode', 'flight.bin'),
    'decode --format csv': ('decode', '--format', 'csv', 'flight.bin'),
    'decode --format jsonl': ('decode', '--format', 'jsonl', 'flight.bin'),
    'report -o -': ('report', 'flight.bin', '-o', '-'),
    'convert': ('convert', 'flight.bin', 'out'),
    'emulate': ('emulate', '--duration', '0.1'),
    'emulate --output -': ('emulate', '--duration', '2', '--output', '-'),
    'emulate --truth -': ('emulate', '--duration', '2', '--output', os.devnull, '--truth', '-'),
}


@pytest.fixture
def shell(tmp_path):
    """Return a function that runs a command of this package in a shell, with redirections."""
    (tmp_path / 'flight.bin').write_bytes(
        b''.join(item.data for item in emissions(make_device(), 2.0)))

    def run(words, redirections):
        return subprocess.run(
            ['sh', '-c', f'{shlex.join(command("bahrs", *words))} {redirections}'],
            cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE, check=False)
    return run


@pytest.mark.parametrize('verb', VERBS)
def test_closed_streams(shell, tmp_path, verb):
    """Output is discarded."""
    for closed in ('>&-', '<&- >&- 2>&-'):
        done = shell(VERBS[verb], closed)
        assert done.returncode == 0 and 'Traceback' not in done.stderr
        shutil.rmtree(tmp_path / 'out', ignore_errors=True)


def test_no_file_is_taken_for_a_stream(shell, tmp_path):
    """The report of a verb is not in the file that it writes."""
    for name, closed in (('open', ''), ('closed', '<&- >&- 2>&-')):
        assert shell(('emulate', '--duration', '2', '--output', name), closed).returncode == 0
    assert (tmp_path / 'closed').read_bytes() == (tmp_path / 'open').read_bytes()


@pytest.mark.parametrize('verb', VERBS)
def test_a_full_disk_behind_standard_output(shell, verb):
    """One sentence."""
    done = shell(VERBS[verb], '> /dev/full')
    assert done.returncode == 1 and 'No space left on device' in done.stderr
    assert len([line for line in done.stderr.splitlines() if line.startswith('bahrs')]) == 1
    assert 'Traceback' not in done.stderr and 'Exception ignored' not in done.stderr


@pytest.mark.parametrize('verb', VERBS)
def test_a_reader_that_has_seen_enough(shell, verb):
    """The command reports nothing."""
    done = shell(VERBS[verb], '| true')
    assert 'bahrs' not in done.stderr and 'Traceback' not in done.stderr


def test_a_driver_without_standard_streams():
    """It publishes, and its log goes neither into the port nor anywhere else."""
    with PtyPort() as port, Device(port), listening(TOPICS) as ear:
        words = shlex.join(command('driver_node', '--ros-args', '-p', f'port:={port.path}'))
        driver = subprocess.Popen(['sh', '-c', f'exec {words} <&- >&- 2>&-'])
        try:
            ear.wait('imu/data', 100)
            assert port.read() == b''
            driver.terminate()
            assert driver.wait(PATIENCE) == 0
        finally:
            driver.kill()
            driver.wait()
