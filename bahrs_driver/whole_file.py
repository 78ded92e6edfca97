# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are written whole or not at all."""

import os
from pathlib import Path
import tempfile


def check_target(path: Path) -> None:
    """Raise ValueError with the reason if a path cannot be that of a file to write."""
    if path.is_dir():
        raise ValueError(f'cannot write {path}: it is a folder')
    if not path.parent.is_dir():
        raise ValueError(f'cannot write {path}: no such folder')
    if not (path.exists() or os.access(path.parent, os.W_OK)):
        raise ValueError(f'cannot write {path}: its folder may not be written into')


def write_whole(path: Path, data: bytes) -> None:
    """Write a file such that nobody ever sees half of it; OSError if it cannot be written."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        path.write_bytes(data)      # a device or a pipe, which must not become a file
        return
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f'.{path.name}.')
    try:
        with os.fdopen(descriptor, 'wb') as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise
