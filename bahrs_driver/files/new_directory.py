# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Directories that appear complete or not at all."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import shutil

from bahrs_driver.files.guard import (
    already_exists, guard, PathLike, split_target, temporary_name,
)


@contextlib.contextmanager
def new_directory(target: PathLike) -> Iterator[Path]:
    """
    Yield the path where the block must create the directory, and then rename that to the target.

    If the block raises, nothing remains. WriteError if the target exists, before or after the
    block, or cannot be made. Parent directories are created when missing.
    """
    parent, name = split_target(str(target).rstrip(os.sep) or str(target))
    scratch = Path(parent, temporary_name())
    with contextlib.ExitStack() as on_failure:
        with guard(target, 'make'):
            with contextlib.suppress(FileNotFoundError):
                os.lstat(target)
                raise already_exists(target)
            for missing in _missing(parent):
                os.mkdir(missing)
                on_failure.callback(_remove_empty, missing)
            scratch.mkdir()
        try:
            yield scratch / name
            with guard(target, 'make'):
                _move(scratch / name, target)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
        on_failure.pop_all()


def _missing(parent: str) -> list[str]:
    """Return the directories on the way to a directory, itself included, that do not exist."""
    missing = []
    while parent and not os.path.lexists(parent):
        missing.append(parent)
        parent = os.path.dirname(parent)
    return missing[::-1]


def _remove_empty(directory: str) -> None:
    with contextlib.suppress(OSError):      # another program has written into it
        os.rmdir(directory)


def _move(made: Path, target: PathLike) -> None:
    # Unlike renaming, which replaces an empty directory, creating fails if there is one.
    try:
        os.mkdir(target)
    except FileExistsError as error:
        raise already_exists(target) from error
    try:
        os.rename(made, target)
    except BaseException:
        _remove_empty(os.fspath(target))
        raise
