# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are written whole or not at all."""

import os
from pathlib import Path
import tempfile


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
