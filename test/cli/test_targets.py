# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the outputs of all verbs, with every kind of target."""

import contextlib
import os
from pathlib import Path
import stat
import subprocess
import tempfile
import threading

from bahrs_driver.cli import report
from bahrs_driver.cli.main import main
from bahrs_driver.cli.outputs import output_file
from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceBehavior
from bahrs_driver.errors import CommandError
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.virtual_serial.pty_port import PtyPort
from hypothesis import given, settings, strategies
import pytest
from support.emulated import emissions, make_device
from support.processes import command, PATIENCE
from support.targets import (
    EVERY_KIND,
    IMPOSSIBLE,
    no_larger_file_than,
    NOT_REGULAR,
    REGULAR,
    snapshot,
    umask,
    unprivileged,
)

EMULATE = ('emulate', '--duration', '0.8')
# Each verb that writes a file which the user names, up to the name. FLIGHT is a recording.
TO_FILE = {
    'report': ('report', 'FLIGHT', '--output'),
    'emulate --output': (*EMULATE, '--output'),
    'emulate --truth': (*EMULATE, '--output', os.devnull, '--truth'),
}
# Each that makes a directory or a link.
TO_NEW = {
    'convert': ('convert', 'FLIGHT'),
    'convert --as csv': ('convert', '--as', 'csv', 'FLIGHT'),
    'convert --as npz': ('convert', '--as', 'npz', 'FLIGHT'),
    'convert --as parquet': ('convert', '--as', 'parquet', 'FLIGHT'),
    'emulate --link': (*EMULATE, '--link'),
}
EVERY_VERB = {**TO_FILE, **TO_NEW}


@pytest.fixture(scope='module')
def flight(tmp_path_factory):
    """Return a file with one second of a stream."""
    file = tmp_path_factory.mktemp('flight') / 'flight.bin'
    file.write_bytes(b''.join(item.data for item in emissions(make_device(), 1.0)))
    return str(file)


@pytest.fixture(scope='module', autouse=True)
def short_page():
    """Make reports without plots, which are slow."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, 'page', lambda recording: ['<!DOCTYPE html>', 'x' * 2000])
        yield


def run(flight, capsys, *words):
    """Run a verb in this process; return its exit status and its errors."""
    try:
        status = main([flight if word == 'FLIGHT' else str(word) for word in words])
    except SystemExit as stop:
        status = stop.code
    return status, capsys.readouterr().err


def refused(flight, capsys, *words):
    """Assert that a verb fails with one sentence, and return it."""
    status, text = run(flight, capsys, *words)
    assert status == 1, text
    sentences = [line for line in text.splitlines() if line.startswith(f'bahrs {words[0]}: ')]
    assert len(sentences) == 1 and sentences[0].isprintable() and 'Traceback' not in text
    return sentences[0]


@pytest.mark.parametrize('verb', EVERY_VERB)
@pytest.mark.parametrize('kind', EVERY_KIND)
def test_an_existing_target_stays(flight, capsys, tmp_path, verb, kind):
    """Only --force replaces a target, and only a regular file."""
    target = tmp_path / 'target'
    EVERY_KIND[kind](target)
    before = snapshot(tmp_path)
    sentence = refused(flight, capsys, *EVERY_VERB[verb], target)
    assert str(target) in sentence and snapshot(tmp_path) == before
    if verb not in TO_FILE:
        return
    if kind.removeprefix('link to ') in REGULAR:
        assert 'or replace it with --force' in sentence
        assert run(flight, capsys, *TO_FILE[verb], target, '--force')[0] == 0
        assert target.stat().st_size > 1000 and set(snapshot(tmp_path)) == set(before)
    else:
        refused(flight, capsys, *TO_FILE[verb], target, '--force')
        assert snapshot(tmp_path) == before


def test_an_empty_name_of_a_directory(flight, capsys):
    """It does not mean the root directory."""
    assert 'without a name' in refused(flight, capsys, 'convert', 'FLIGHT', '')


@pytest.mark.parametrize('verb', EVERY_VERB)
@pytest.mark.parametrize('kind', IMPOSSIBLE)
def test_paths_that_cannot_be_written(flight, capsys, tmp_path, verb, kind, monkeypatch):
    """The error is one sentence, and no file remains."""
    if verb in TO_NEW and kind in ('missing parent', 'trailing slash'):
        return          # is made
    monkeypatch.chdir(tmp_path)
    Path('file').touch()
    before = snapshot(tmp_path)
    refused(flight, capsys, *EVERY_VERB[verb], IMPOSSIBLE[kind])
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize('verb', EVERY_VERB)
def test_a_directory_without_write_permission(flight, capsys, verb):
    """The error is one sentence with a remedy, before the work begins."""
    with tempfile.TemporaryDirectory() as top:
        copy = Path(top, 'flight.bin')
        copy.write_bytes(Path(flight).read_bytes())
        os.chmod(top, 0o555)
        with unprivileged():
            sentence = refused(str(copy), capsys, *EVERY_VERB[verb], f'{top}/target')
        assert 'Permission denied: choose another directory' in sentence
        os.chmod(top, 0o755)
        assert os.listdir(top) == ['flight.bin']


@pytest.mark.parametrize('verb', sorted(set(EVERY_VERB) - {'emulate --link'}))
def test_a_full_disk(flight, capsys, tmp_path, verb):
    """The error is one sentence with a remedy, and no incomplete file remains."""
    with no_larger_file_than(100):
        sentence = refused(flight, capsys, *EVERY_VERB[verb], tmp_path / 'target')
    assert f'cannot write {tmp_path}/target' in sentence
    assert 'File too large: choose another directory' in sentence
    assert '.partial' not in sentence and 'all earlier messages' not in sentence
    assert set(os.listdir(tmp_path)) <= ({'target'} if verb == 'emulate --truth' else set())


@pytest.mark.parametrize('verb', sorted(set(EVERY_VERB) - {'emulate --link'}))
def test_modes_respect_the_umask(flight, capsys, tmp_path, verb):
    """This holds for files and directories."""
    with umask(0o027):
        assert run(flight, capsys, *EVERY_VERB[verb], tmp_path / 'target')[0] == 0
    modes = {path.is_dir(): stat.S_IMODE(path.stat().st_mode) for path in tmp_path.rglob('*')}
    assert modes.get(True, 0o750) == 0o750 and modes[False] == 0o640


@pytest.mark.parametrize('verb', TO_FILE)
@pytest.mark.parametrize('name', ['-', '/dev/stdout'])
def test_standard_output(flight, verb, name):
    """Only the content of the file is printed."""
    words = [flight if word == 'FLIGHT' else word for word in TO_FILE[verb]]
    done = subprocess.run(command('bahrs', *words, name), capture_output=True, check=True,
                          timeout=PATIENCE)
    begins = {'report': b'<!DOCTYPE html>', 'emulate --output': b'NE',
              'emulate --truth': b'{"message"'}
    assert done.stdout.startswith(begins[verb])


def test_truth_and_output_must_differ(flight, capsys, tmp_path):
    """Two names of the same file are refused."""
    (tmp_path / 'link').symlink_to('file')
    for name in (tmp_path / 'file', tmp_path / 'link', f'{tmp_path}/./file'):
        sentence = refused(flight, capsys, *EMULATE, '--force', '--output', tmp_path / 'file',
                           '--truth', name)
        assert 'choose another name for one of them' in sentence
    assert not (tmp_path / 'file').exists()


def test_two_writers_of_one_file(tmp_path):
    """The first to finish writes it; the other fails, and its file is removed."""
    path = str(tmp_path / 'file')
    with pytest.raises(CommandError, match='exists already'), output_file(path, False) as first:
        first.write(b'first')
        with output_file(path, False) as second:
            second.write(b'second')
    assert Path(path).read_bytes() == b'second' and os.listdir(tmp_path) == ['file']


class Memory(threading.Thread):
    """A device on a port that only answers requests for its memory."""

    def __init__(self, port):
        """Keep the port."""
        super().__init__(daemon=True)
        self._port, self.ended, self.asked = port, threading.Event(), False

    def run(self):
        """Answer until it is stopped."""
        codec, mode = BahrsCodec(), DiagnosticsMode(ServiceBehavior())
        while not self.ended.is_set():
            data = self._port.read(0.01)
            self.asked = self.asked or bool(data)
            for answer in mode.receive(data, 0.0):
                self._port.write(codec.encode(answer, 3))


def test_a_dump_is_refused_before_any_request(flight, capsys, tmp_path):
    """This holds for all kinds of targets. A valid target is written."""
    with PtyPort() as port:
        memory = Memory(port)
        memory.start()
        dump = ('nvm', 'dump', '--port', port.path)
        for kind, make in EVERY_KIND.items():
            make(tmp_path / kind)
            before = snapshot(tmp_path)
            refused(flight, capsys, *dump, tmp_path / kind)
            if kind.removeprefix('link to ') not in REGULAR:
                refused(flight, capsys, *dump, tmp_path / kind, '--force')
            assert snapshot(tmp_path) == before
        for path in (port.path, '/nowhere/x', '.'):
            refused(flight, capsys, *dump, path, '--force')
        memory.ended.set()
        memory.join()
        assert not memory.asked


@pytest.mark.parametrize('verb', sorted(set(EVERY_VERB) - {'emulate --link'}))
def test_no_regular_file_in_dev(flight, capsys, verb):
    """With the name of an unplugged device, it would hide the device."""
    sentence = refused(flight, capsys, *EVERY_VERB[verb], '/dev/bahrs_unplugged')
    assert not os.path.lexists('/dev/bahrs_unplugged')
    assert sentence.endswith(': /dev is for devices, choose a directory elsewhere')


TEXT = strategies.text(strategies.characters(codec=None, exclude_characters='/'), max_size=20)
PIECES = strategies.sampled_from([
    '..', '.', '~', '-', 'FIFO', 'socket', 'out', 'kept', '\x1b[2J', '\udcff', '\ud800', '\n',
    ' ', 'x' * 255, 'ü', '%s', '[red]', '{}'])
# Where no user can create a file.
NOWHERE = strategies.sampled_from(
    ['/dev/full', '/dev/full/bahrs', '/proc/bahrs', '/proc/self/mem'])
# Relative, and never higher than `playground` is deep: nothing is made elsewhere on the machine.
NAMES = NOWHERE | strategies.lists(PIECES | TEXT, min_size=1, max_size=4).map(
    lambda parts: '/'.join(['.', *parts]))


@contextlib.contextmanager
def playground():
    """Change to a directory in one with files that must not change."""
    with tempfile.TemporaryDirectory() as top:
        inner, here = Path(top, 'a', 'b', 'c', 'd', 'e'), os.getcwd()
        inner.mkdir(parents=True)
        os.mkfifo(inner / 'FIFO')
        NOT_REGULAR['socket'](inner / 'socket')
        (inner / 'kept').write_bytes(b'precious')
        os.chdir(inner)
        try:
            yield top
        finally:
            os.chdir(here)


def words_of(flight, verb, name):
    """Return the command line of a verb with a target."""
    *words, last = (flight if word == 'FLIGHT' else word for word in EVERY_VERB[verb])
    return [*words, f'{last}={name}'] if last.startswith('--') else [*words, last, '--', name]


@given(strategies.sampled_from(sorted(TO_FILE)), strategies.booleans(), NAMES)
def test_any_name_gives_a_file_or_one_sentence(flight, verb, force, name):
    """For any name, no other file changes, and no exception escapes."""
    with playground() as top:
        before = snapshot(top)
        status = main(words_of(flight, verb, name) + (['--force'] if force else []))
        after = snapshot(top)
        changed = {name: item for name, item in after.items() if before.get(name) != item}
        assert set(before) <= set(after)
        assert all(stat.S_ISREG(mode) for mode, _ in changed.values())
        assert len(changed) <= (status == 0), changed
        assert force or not set(changed) & set(before)


@settings(max_examples=60)
@given(strategies.sampled_from(sorted(TO_NEW)), NAMES)
def test_any_name_gives_something_new_or_one_sentence(flight, verb, name):
    """Existing files do not change, and a failure leaves no directory or link."""
    with playground() as top:
        before = snapshot(top)
        status = main(words_of(flight, verb, name))
        after = snapshot(top)
        assert before.items() <= after.items()
        assert status == 0 or after == before
