# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The file that the service ~/nvm/dump writes.

Every node on the ROS graph can set nvm.dump_path and call the service. So the path must name a
regular file inside a directory that is fixed when the driver starts.
"""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path

from bahrs_driver.errors import WriteError
from bahrs_driver.files.atomic_file import atomic_file_inside, AtomicFile
from bahrs_driver.files.guard import guard


@contextlib.contextmanager
def dump_file(directory: str, path: str) -> Iterator[tuple[str, AtomicFile]]:
    """
    Yield the path of a dump and the file, to be written and committed.

    A missing directory is created, and a path that is not absolute is relative to it. A regular
    file is replaced. WriteError names the parameter and the reason.
    """
    with _parameter('nvm.directory'):
        root = os.path.abspath(_expanded(directory))
        with guard(root, 'make'):
            os.makedirs(root, exist_ok=True)
    with _parameter('nvm.dump_path'):
        target = os.path.join(root, _expanded(path))
        file = atomic_file_inside(root, target, target, replace=True)
    with file:
        yield target, file


def _expanded(path: str) -> str:
    """Return a path with the home directory that ~ or ~user stands for."""
    with guard(path):
        return str(Path(path).expanduser())


@contextlib.contextmanager
def _parameter(name: str) -> Iterator[None]:
    try:
        yield
    except WriteError as error:
        raise WriteError(f'parameter {name}: {error}') from error
