# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of files that are written whole or not at all."""

import os
import threading

from bahrs_driver.whole_file import check_target, write_whole
import pytest


def test_a_file_is_replaced(tmp_path):
    """Nothing else is left in the folder."""
    path = tmp_path / 'file'
    path.write_bytes(b'before')
    write_whole(path, b'after')
    assert path.read_bytes() == b'after'
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_no_file_stays_so(tmp_path):
    """A pipe or a device is written into, and not replaced by a file."""
    path = tmp_path / 'pipe'
    os.mkfifo(path)
    heard = []
    reader = threading.Thread(target=lambda: heard.append(path.read_bytes()), daemon=True)
    reader.start()
    write_whole(path, b'page')
    reader.join(30)
    assert heard == [b'page'] and path.is_fifo()


def test_what_cannot_be_a_file_is_told_beforehand(tmp_path):
    """With the reason."""
    check_target(tmp_path / 'new')
    with pytest.raises(ValueError, match='it is a folder'):
        check_target(tmp_path)
    with pytest.raises(ValueError, match='no such folder'):
        check_target(tmp_path / 'nowhere' / 'new')
