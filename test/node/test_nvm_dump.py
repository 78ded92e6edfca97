# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of where a dump of the memory may be written."""

import os
from pathlib import Path
import stat
import tempfile

from bahrs_driver.errors import WriteError
from bahrs_driver.node.nvm_dump import dump_file
from hypothesis import given, strategies
import pytest
from support.targets import no_larger_file_than, snapshot, umask, unprivileged


def dump(directory, path='bahrs_nvm.bin', data=b'image'):
    """Write a dump; return its path."""
    with dump_file(str(directory), path) as (shown, file):
        file.write(data)
        file.commit()
    return shown


def test_the_directory_is_made(tmp_path, monkeypatch):
    """With its parents, below the home directory; modes honour the umask."""
    monkeypatch.setenv('HOME', str(tmp_path))
    with umask(0o027):
        shown = dump('~/some/dumps')
    assert shown == str(tmp_path / 'some' / 'dumps' / 'bahrs_nvm.bin')
    assert Path(shown).read_bytes() == b'image'
    assert stat.S_IMODE(os.stat(shown).st_mode) == 0o640
    assert stat.S_IMODE((tmp_path / 'some' / 'dumps').stat().st_mode) == 0o750


def test_a_later_dump_replaces_an_earlier_one(tmp_path):
    """By any path; a relative directory is below that of the process."""
    for path in ('dump', f'{tmp_path}/dump', './dump', 'sub/../dump'):
        (tmp_path / 'sub').mkdir(exist_ok=True)
        dump(tmp_path, path, path.encode())
        assert (tmp_path / 'dump').read_bytes() == path.encode()


def test_an_earlier_dump_stays_if_the_next_one_fails(tmp_path):
    """Without all pages, or without space."""
    dump(tmp_path)
    with pytest.raises(KeyError), dump_file(str(tmp_path), 'bahrs_nvm.bin'):
        raise KeyError
    with no_larger_file_than(100), pytest.raises(WriteError, match='File too large'):
        dump(tmp_path, data=bytes(8000))
    assert (tmp_path / 'bahrs_nvm.bin').read_bytes() == b'image'
    assert os.listdir(tmp_path) == ['bahrs_nvm.bin']


@pytest.mark.parametrize('directory, path, name', [
    ('~nosuchuser', 'x', 'nvm.directory'), ('/proc/x', 'x', 'nvm.directory'),
    ('/dev/null', 'x', 'nvm.directory'), ('a\0b', 'x', 'nvm.directory'),
    ('DIR', '~nosuchuser/x', 'nvm.dump_path'), ('DIR', '/dev/null', 'nvm.dump_path'),
    ('/dev', 'ttyUSB0', 'nvm.dump_path'), ('/dev', 'null', 'nvm.dump_path')])
def test_which_parameter_is_wrong(tmp_path, directory, path, name):
    """The sentence names it."""
    before = set(os.listdir('/dev'))
    with pytest.raises(WriteError, match=f'^parameter {name}: cannot '):
        dump(directory.replace('DIR', str(tmp_path)), path)
    assert set(os.listdir('/dev')) <= before | {'ptmx', 'shm'} and not list(tmp_path.iterdir())


def test_a_user_without_a_home(monkeypatch):
    """Such as for a service without HOME: the sentence has the reason."""
    monkeypatch.delenv('HOME')
    with unprivileged(), tempfile.TemporaryDirectory() as top:
        assert dump(top) == f'{top}/bahrs_nvm.bin'
        os.chmod(top, 0o500)
        with pytest.raises(WriteError, match='nvm.dump_path: .*Permission denied'):
            dump(top)
        with pytest.raises(WriteError, match='nvm.directory: .*Permission denied'):
            dump(f'{top}/more')
        os.chmod(top, 0o700)


PARTS = strategies.sampled_from(['..', '.', '', '~', '~nosuchuser', 'sub', 'out', 'kept', 'new'])


@given(strategies.lists(PARTS, min_size=1, max_size=6) | strategies.lists(strategies.text()),
       strategies.sampled_from(['', '/', 'TOP/', 'TOP/root/']))
def test_no_path_leads_out(parts, begin):
    """At most one file inside is new or replaced."""
    with tempfile.TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
        top = Path(name).resolve()
        patch.setenv('HOME', str(top))
        (top / 'root' / 'sub').mkdir(parents=True)
        (top / 'root' / 'out').symlink_to('..')
        (top / 'kept').touch()
        before = snapshot(top)
        path = begin.replace('TOP', str(top)) + '/'.join(parts)
        try:
            dump(top / 'root', path)
        except WriteError as error:
            assert str(error).isprintable() and snapshot(top) == before
        else:
            changed = dict(snapshot(top).items() - before.items())
            assert [content for _, content in changed.values()] == [b'image']
            assert all(made.startswith(b'root/') for made in changed)
