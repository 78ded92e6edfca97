# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of text files that other programs read while they grow."""

import stat

from bahrs_driver.errors import WriteError
from bahrs_driver.files.live_file import LiveFile
import pytest
from support.targets import EVERY_KIND, IMPOSSIBLE, no_larger_file_than, REGULAR, snapshot, umask


def test_text_is_visible_after_each_flush(tmp_path):
    """The mode of the file honours the umask."""
    path = tmp_path / 'file'
    with umask(0o027):
        file = LiveFile(path)
    file.write('grüße\n')
    file.flush()
    assert path.read_text(encoding='utf-8') == 'grüße\n'
    file.close()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


@pytest.mark.parametrize('kind', EVERY_KIND)
@pytest.mark.parametrize('replace', [False, True])
def test_only_regular_files_are_replaced_and_only_on_demand(tmp_path, kind, replace):
    """No other file is opened."""
    path = tmp_path / 'target'
    EVERY_KIND[kind](path)
    before = snapshot(tmp_path)
    if replace and kind.removeprefix('link to ') in REGULAR:
        path.chmod(0o600)
        LiveFile(path, replace).close()
        assert path.read_bytes() == b'' and set(snapshot(tmp_path)) == set(before)
    else:
        with pytest.raises(WriteError):
            LiveFile(path, replace)
        assert snapshot(tmp_path) == before


@pytest.mark.parametrize('kind', IMPOSSIBLE)
def test_paths_that_cannot_be_written(tmp_path, kind, monkeypatch):
    """A WriteError is raised."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'file').touch()
    with pytest.raises(WriteError, match='cannot write'):
        LiveFile(IMPOSSIBLE[kind], replace=True)


def test_no_room(tmp_path):
    """Writing, flushing and closing raise WriteError."""
    file = LiveFile(tmp_path / 'file')
    with no_larger_file_than(10):
        file.write('more than ten characters')
        with pytest.raises(WriteError, match='too large: choose another directory'):
            file.flush()
        with pytest.raises(WriteError):
            file.close()
