# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of directories that appear complete or not at all."""

import stat

from bahrs_driver.errors import TargetExists, WriteError
from bahrs_driver.files.new_directory import new_directory
import pytest
from support.targets import EVERY_KIND, IMPOSSIBLE, snapshot, umask, unprivileged


def fill(folder):
    """Make a directory with a file in it."""
    folder.mkdir()
    (folder / 'file').write_bytes(b'new')


@pytest.mark.parametrize('name', ['out', 'missing/parents/out', 'out/', 'x' * 255])
def test_it_appears_at_the_end_of_the_block(tmp_path, name):
    """It is complete, its parents exist, and no temporary directory remains."""
    target = tmp_path / name
    with umask(0o027):
        with new_directory(f'{tmp_path}/{name}') as folder:
            fill(folder)
            assert not target.exists()
    assert [path for path in tmp_path.rglob('*') if path.is_file()] == [target / 'file']
    assert not list(tmp_path.rglob('.*'))
    assert stat.S_IMODE(target.stat().st_mode) == 0o750


def test_nothing_remains_of_a_block_that_raises(tmp_path):
    """Files of other programs are not removed."""
    (tmp_path / '.out.partial').mkdir()
    (tmp_path / '.out.partial' / 'kept').touch()
    before = snapshot(tmp_path)
    for error in (ValueError, KeyboardInterrupt):
        for name in ('out', 'missing/parents/out'):
            with pytest.raises(error), new_directory(tmp_path / name) as folder:
                fill(folder)
                raise error
    assert snapshot(tmp_path) == before
    with pytest.raises(ValueError), new_directory(tmp_path / 'missing' / 'parents' / 'out'):
        (tmp_path / 'missing' / 'others').touch()
        raise ValueError
    assert set(snapshot(tmp_path)) == {*before, b'missing', b'missing/others'}


@pytest.mark.parametrize('kind', EVERY_KIND)
def test_what_exists_is_left_alone(tmp_path, kind):
    """This holds before the block and after it, and for an empty directory, too."""
    target = tmp_path / 'out'
    EVERY_KIND[kind](target)
    before = snapshot(tmp_path)
    with pytest.raises(TargetExists, match='exists already'), new_directory(target):
        raise AssertionError('the work was begun')
    assert snapshot(tmp_path) == before

    later = tmp_path / 'later'
    with pytest.raises(TargetExists), new_directory(later) as folder:
        fill(folder)
        EVERY_KIND[kind](later)
        before = {name: item for name, item in snapshot(tmp_path).items()
                  if b'.partial' not in name}
    assert snapshot(tmp_path) == before


def test_two_at_once(tmp_path):
    """The first to finish succeeds; the other one raises TargetExists and removes no file."""
    with pytest.raises(TargetExists), new_directory(tmp_path / 'out') as slow:
        fill(slow)
        with new_directory(tmp_path / 'out') as fast:
            fill(fast)
            assert slow != fast
    assert (tmp_path / 'out' / 'file').exists() and not list(tmp_path.glob('.*'))


@pytest.mark.parametrize('kind', sorted(set(IMPOSSIBLE) - {'missing parent', 'trailing slash'}))
def test_paths_that_cannot_be_made(tmp_path, kind, monkeypatch):
    """A WriteError is raised before the block, or when the directory is renamed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'file').touch()
    before = snapshot(tmp_path)
    with pytest.raises(WriteError), new_directory(IMPOSSIBLE[kind]) as folder:
        fill(folder)
    assert snapshot(tmp_path) == before


def test_a_directory_that_is_not_writable(tmp_path_factory):
    """A WriteError is raised before the block."""
    top = tmp_path_factory.mktemp('closed')
    for path in (top, top.parent, top.parent.parent):
        path.chmod(0o755)
    top.chmod(0o555)
    with unprivileged(), pytest.raises(WriteError, match='Permission denied'), \
            new_directory(top / 'out'):
        raise AssertionError('the work was begun')
