# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Directories that appear complete or not at all."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
import shutil

from bahrs_driver.files.guard import (
    guard, PathLike, split_target, TargetExists, temporary_name,
)


@contextlib.contextmanager
def new_directory(target: PathLike) -> Iterator[Path]:
    """
    Yield a path to make a directory at; it becomes the target when the block ends.

    If the block raises, nothing remains. WriteError if the target exists, before or after, or
    cannot be made. Parent directories are created when missing.
    """
    parent, name = split_target(str(target).rstrip(os.sep) or str(target))
    scratch = Path(parent, temporary_name())
    with guard(target, 'make'):
        with contextlib.suppress(FileNotFoundError):
            os.lstat(target)
            raise TargetExists(target)
        os.makedirs(parent, exist_ok=True)
        scratch.mkdir()
    try:
        yield scratch / name
        with guard(target, 'make'):
            _move(scratch / name, target)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _move(made: Path, target: PathLike) -> None:
    # Renaming replaces an empty directory; only creating it fails if there is one.
    try:
        os.mkdir(target)
    except FileExistsError as error:
        raise TargetExists(target) from error
    try:
        os.rename(made, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.rmdir(target)
        raise
