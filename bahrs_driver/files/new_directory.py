# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Create directories that must not exist yet."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import shutil

from bahrs_driver.files.guard import (
    already_exists, guard_new, PathLike, refuse_new_device, split_target, temporary_name)


def make_directory(target: Path) -> None:
    """Make a directory with its parents; WriteError if it exists or cannot be made."""
    with guard_new(target, 'make'):
        refuse_new_device(target)
        target.mkdir(parents=True)


@contextlib.contextmanager
def new_directory(target: PathLike) -> Iterator[Path]:
    """
    Make a directory that appears complete or not at all.

    The block must create a directory at the yielded path, which is in a hidden directory beside
    the target. After the block it is renamed to the target; if the block raises, it is removed.
    Missing parents of the target are made. WriteError if the target exists, before or after the
    block, or cannot be made.
    """
    parent, name = split_target(str(target).rstrip(os.sep) or str(target))
    hidden = Path(parent, temporary_name())
    with contextlib.ExitStack() as on_failure:
        with guard_new(target, 'make'):
            _refuse_existing(target)
            for missing in _missing(parent):
                os.mkdir(missing)
                on_failure.callback(_remove_empty, missing)
            hidden.mkdir()
        try:
            yield hidden / name
            with guard_new(target, 'make'):
                os.mkdir(target)        # fails if it exists, unlike renaming to an empty directory
                on_failure.callback(_remove_empty, target)
                os.rename(hidden / name, target)
        finally:
            shutil.rmtree(hidden, ignore_errors=True)
        on_failure.pop_all()


def _refuse_existing(target: PathLike) -> None:
    with contextlib.suppress(FileNotFoundError):
        os.lstat(target)                # unlike lexists(), it raises for an impossible name
        raise already_exists(target)


def _missing(parent: str) -> list[str]:
    """Return a directory and those above it, as far as they do not exist, the topmost first."""
    missing = []
    while parent and not os.path.lexists(parent):
        missing.append(parent)
        parent = os.path.dirname(parent)
    return missing[::-1]


def _remove_empty(directory: PathLike) -> None:
    with contextlib.suppress(OSError):
        os.rmdir(directory)
