# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of names of files with any bytes, which verbs print in printable form."""

import itertools
import os
import subprocess

from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.process.printable import printable
import pytest
from rosbags.rosbag2 import Reader
from support.bags import write_mcap
from support.emulated import emissions, make_device
from support.processes import command, running, wait_for

# Bytes that are no UTF-8, an escape sequence, a line feed, markup of rich, a mark that mirrors.
NAME, SHOWN = b'\xff\x1b[31m\n[bold]\xe2\x80\xae', r'\xff\x1b[31m\x0a[bold]\u202e'
NAMES = [NAME, b'\x1bc', b'-\xc3\xa4 \xed\xa0\x80']


def run(*words, cwd, timeout=60):
    """Run a verb with an output that accepts only UTF-8; return its status and output."""
    done = subprocess.run(
        [os.fsencode(word) for word in (*command('bahrs'), *words)], cwd=cwd, check=False,
        capture_output=True, timeout=timeout,
        env={**os.environ, 'PYTHONIOENCODING': 'utf-8:strict'})
    assert b'Traceback' not in done.stderr
    return done.returncode, done.stdout, done.stderr


@pytest.fixture(scope='module')
def stream():
    """Return two seconds of a stream."""
    return b''.join(item.data for item in emissions(make_device(), 2.0))


@pytest.mark.parametrize('name', NAMES)
def test_files_with_any_name(tmp_path, stream, name):
    """Verbs read and write the named files."""
    source, folder = b'./' + name, os.fsencode(tmp_path)
    (tmp_path / os.fsdecode(name)).write_bytes(stream)
    assert run('decode', source, cwd=tmp_path)[0] == 0
    assert run('report', source, '-o', source + b'.html', cwd=tmp_path)[0] == 0
    status, out, _ = run('convert', source, source + b'.bag', cwd=tmp_path)
    assert status == 0 and printable(os.fsdecode(name)).encode() in out
    assert run('convert', source, source + b'.csv', '--as', 'csv', cwd=tmp_path)[0] == 0
    made = {name + suffix for suffix in (b'', b'.html', b'.bag', b'.csv')}
    assert {*os.listdir(folder)} == made
    with Reader(tmp_path / os.fsdecode(name + b'.bag')) as reader:
        assert reader.message_count > 1000


@pytest.mark.parametrize('words', [
    ['decode', None], ['convert', None, 'out'], ['report', None], ['replay', None],
    ['nvm', 'show', None], ['convert', 'bag.mcap', 'out', '--topic', None],
    ['convert', 'bag.mcap', None], ['report', 'bag.mcap', '-o', None],
    ['replay', 'bag.mcap', '--link', None], ['emulate', '--link', None],
    ['convert', 'bag.mcap', 'out', '--namespace', None], ['record', '--node', None],
    ['record', '-o', None]],
    ids=lambda words: ' '.join(word or 'NAME' for word in words))
def test_errors_are_printable(tmp_path, words):
    """The error is one line, in which the name is escaped."""
    write_mcap(tmp_path / 'bag.mcap')
    (tmp_path / os.fsdecode(NAME)).mkdir()          # which is none of what it should be
    chosen = [b'./' + NAME if word is None else word for word in words]
    if words[-2] in ('--topic', '--namespace', '--node'):
        chosen[-1] = NAME
    status, _, err = run(*chosen, cwd=tmp_path)
    assert status in (1, 2)
    if status == 1:
        assert err.count(b'\n') == 1
    assert err.decode().replace('\n', '').isprintable()
    assert SHOWN in err.decode() or repr(os.fsdecode(NAME))[1:-1] in err.decode()


def test_command_line_errors_are_printable(tmp_path):
    """Messages of argparse are escaped, too."""
    for name in NAMES:
        for words in ([name], ['decode', 'x', name + b'x'], ['replay', 'x', '--fault', name]):
            status, _, err = run(*words, cwd=tmp_path)
            assert status == 2 and err.decode().replace('\n', '').isprintable()


def test_bags_in_directories_with_any_name(tmp_path):
    """The files have its name without characters that metadata.yaml cannot have."""
    for name, kind in itertools.product(NAMES, ('mcap', 'folder')):
        folder = tmp_path / os.fsdecode(name + kind.encode())
        folder.mkdir()
        write_mcap(folder / 'bag_0.mcap')
        capture = open_capture(folder / 'bag_0.mcap' if kind == 'mcap' else folder)
        assert len(list(capture.chunks())) == 10


def test_recording_to_a_directory_with_any_name(tmp_path):
    """The directory is created, and errors show its escaped name."""
    folder = tmp_path / os.fsdecode(b'\xff\x1b[31m')
    with running('bahrs', 'record', '-o', str(folder)) as recorder:
        assert wait_for(lambda: list(folder.glob('*.mcap')))
        assert recorder.end() == 1
    assert r'\xff\x1b[31m is empty' in recorder.text
    assert [file.name for file in folder.glob('*.mcap')] == ['__[31m_0.mcap']
