# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of files that appear complete or not at all."""

import os
from pathlib import Path
import stat
import tempfile
import threading

from bahrs_driver.errors import TargetExists, WriteError
from bahrs_driver.files.atomic_file import atomic_file, atomic_file_inside, write_atomic
from hypothesis import given, strategies
import pytest
from support.targets import (
    EVERY_KIND, IMPOSSIBLE, no_larger_file_than, PRECIOUS, REGULAR, snapshot, umask, unprivileged,
)


def test_the_target_changes_when_the_file_is_committed(tmp_path):
    """This holds for a new target and for one that is replaced."""
    path = tmp_path / 'file'
    for replace, before in ((False, None), (True, b'first')):
        with atomic_file(path, replace) as file:
            file.write(b'second' if replace else b'first')
            assert (path.read_bytes() if path.exists() else None) == before
            file.commit()
    assert path.read_bytes() == b'second' and list(tmp_path.iterdir()) == [path]


def test_a_file_that_is_not_committed_leaves_nothing(tmp_path):
    """This holds if the writer raises an exception, too."""
    with atomic_file(tmp_path / 'file') as file:
        file.write(b'data')
    with pytest.raises(KeyboardInterrupt), atomic_file(tmp_path / 'file'):
        raise KeyboardInterrupt
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('mask', [0o022, 0o077, 0o002])
def test_modes_honour_the_umask(tmp_path, mask):
    """The mode is that of any new file."""
    with umask(mask):
        write_atomic(tmp_path / 'file', b'')
    assert stat.S_IMODE((tmp_path / 'file').stat().st_mode) == 0o666 & ~mask


@pytest.mark.parametrize('kind', EVERY_KIND)
@pytest.mark.parametrize('replace', [False, True])
def test_only_regular_files_are_replaced_and_only_on_demand(tmp_path, kind, replace):
    """Other files do not change, and a link remains a link."""
    path = tmp_path / 'target'
    EVERY_KIND[kind](path)
    before = snapshot(tmp_path)
    if replace and kind.removeprefix('link to ') in REGULAR:
        write_atomic(path, b'new', replace=True)
        assert path.read_bytes() == b'new'
        assert set(snapshot(tmp_path)) == set(before)
        assert path.is_symlink() == kind.startswith('link')
    else:
        with pytest.raises(WriteError) as error:
            write_atomic(path, b'new', replace)
        assert str(path) in str(error.value)
        assert snapshot(tmp_path) == before


@pytest.mark.parametrize('kind', IMPOSSIBLE)
def test_paths_that_cannot_be_written(tmp_path, kind, monkeypatch):
    """A WriteError is raised, and no file changes."""
    monkeypatch.chdir(tmp_path)
    Path('file').write_bytes(PRECIOUS)
    before = snapshot(tmp_path)
    with pytest.raises(WriteError, match='cannot write'):
        write_atomic(IMPOSSIBLE[kind], b'new', replace=True)
    assert snapshot(tmp_path) == before


def test_a_directory_that_is_not_writable():
    """A WriteError is raised when the file is created, before there is data."""
    with tempfile.TemporaryDirectory() as top:
        os.chmod(top, 0o555)
        with unprivileged(), pytest.raises(WriteError, match='Permission denied: choose another'):
            atomic_file(Path(top, 'file'))
        os.chmod(top, 0o755)


def test_no_room(tmp_path):
    """The existing file does not change, and no temporary file remains."""
    path = tmp_path / 'file'
    path.write_bytes(PRECIOUS)
    with no_larger_file_than(1000), pytest.raises(WriteError, match='too large: choose another'):
        write_atomic(path, bytes(2000), replace=True)
    assert path.read_bytes() == PRECIOUS and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize('kind', EVERY_KIND)
@pytest.mark.parametrize('replace', [False, True])
def test_a_target_that_appears_before_the_commit(tmp_path, kind, replace):
    """It stays, unless it is a regular file and may be replaced; a link is not followed."""
    path = tmp_path / 'target'
    with atomic_file(path, replace) as file:
        file.write(b'new')
        EVERY_KIND[kind](path)
        before = {name: item for name, item in snapshot(tmp_path).items()
                  if not name.endswith(b'.partial')}
        if replace and kind in REGULAR:
            file.commit()
        else:
            with pytest.raises(WriteError):
                file.commit()
    if replace and kind in REGULAR:
        assert path.read_bytes() == b'new' and set(snapshot(tmp_path)) == set(before)
    else:
        assert snapshot(tmp_path) == before


def test_several_writers_of_one_file(tmp_path):
    """Without replace, one of them succeeds, and the others get TargetExists."""
    path, refused = tmp_path / 'file', []
    start = threading.Barrier(8)

    def write(number):
        with atomic_file(path) as file:
            file.write(bytes([number]) * 100_000)
            start.wait()
            try:
                file.commit()
            except TargetExists:
                refused.append(number)

    threads = [threading.Thread(target=write, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(refused) == 7 and list(tmp_path.iterdir()) == [path]
    number, = set(range(8)) - set(refused)
    assert path.read_bytes() == bytes([number]) * 100_000


def test_inside_a_directory_only(tmp_path):
    """The path is relative or absolute, and may contain links inside the directory."""
    root = tmp_path / 'root'
    (root / 'sub').mkdir(parents=True)
    (root / 'link').symlink_to('sub')
    (tmp_path / 'root_link').symlink_to(root)
    for number, path in enumerate((
            'a', 'sub/a', 'sub/../a', 'link/a', root / 'a', tmp_path / 'root_link' / 'a')):
        for top in (root, tmp_path / 'root_link'):
            with atomic_file_inside(top, path, 'x', replace=True) as file:
                file.write(bytes([number]))
                file.commit()
            assert (root / path).read_bytes() == bytes([number])


@pytest.mark.parametrize('path', [
    '../outside', 'sub/../../outside', '/etc/outside', 'out/outside', 'sub/out/outside', '/',
    '/dev/ttyS0', '..', '', '.', 'sub', 'target_link', 'missing/a', 'a\0b', 'x' * 300])
def test_paths_outside_the_directory(tmp_path, path):
    """They are rejected, and so is a link as the target."""
    root = tmp_path / 'root'
    (root / 'sub').mkdir(parents=True)
    (root / 'out').symlink_to(tmp_path)
    (root / 'sub' / 'out').symlink_to('../..')
    (root / 'target_link').symlink_to('regular')
    (root / 'regular').write_bytes(PRECIOUS)
    before = snapshot(tmp_path)
    with pytest.raises(WriteError, match='cannot write'):
        atomic_file_inside(root, path, path or 'nothing', replace=True)
    assert snapshot(tmp_path) == before


def test_a_directory_that_is_replaced_by_a_link(tmp_path):
    """The file is written to the directory that was checked."""
    root, aside = tmp_path / 'root', tmp_path / 'aside'
    (root / 'sub').mkdir(parents=True)
    aside.mkdir()
    with atomic_file_inside(root, 'sub/a', 'sub/a') as file:
        (root / 'sub').rename(root / 'moved')
        (root / 'sub').symlink_to(aside)
        file.write(b'data')
        file.commit()
    assert (root / 'moved' / 'a').read_bytes() == b'data' and not list(aside.iterdir())


PARTS = strategies.sampled_from([
    '..', '.', '', 'sub', 'out', 'file', 'loop', 'deep', 'new', '~', '-', '\0', '\x1b[2J',
    '\udcff', '\ud800', 'x' * 256, 'ü'])


@given(strategies.lists(PARTS, max_size=6), strategies.booleans(), strategies.booleans())
def test_no_path_leads_out_or_raises_anything_else(parts, absolute, replace):
    """For any path, at most one file is new or replaced, and it is inside."""
    with tempfile.TemporaryDirectory() as name:
        top = Path(name).resolve()
        root = top / 'root'
        (root / 'sub' / 'deep').mkdir(parents=True)
        (root / 'out').symlink_to('..')
        (root / 'sub' / 'out').symlink_to('/')
        (root / 'loop').symlink_to('loop')
        (root / 'sub' / 'file').write_bytes(PRECIOUS)
        (top / 'new').write_bytes(PRECIOUS)
        before = snapshot(top)
        path = '/'.join(([str(root)] if absolute else []) + parts)
        try:
            with atomic_file_inside(root, path, path, replace) as file:
                file.write(b'new')
                file.commit()
        except WriteError as error:
            assert str(error).isprintable() and snapshot(top) == before
            return
        changed = dict(snapshot(top).items() - before.items())
        assert [content for _, content in changed.values()] == [b'new']
        assert all(name.startswith(b'root/') for name in changed)
        assert replace or not set(changed) & set(before)
