# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Files that appear complete or not at all.

The data goes into a temporary file beside the target, which is created before the work that makes
the data, so that a directory that cannot be written into is found out first. commit() gives it
the target's name. The directory is held open meanwhile: nothing that happens to its path, and no
symbolic link put where the target was absent, leads the data elsewhere.
"""

import contextlib
import os

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import (
    already_exists, check_target, guard, named_target, PathLike, split_target, temporary_name)
from bahrs_driver.process.printable import printable

_DIRECTORY = os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
_MODE = 0o666               # less what the umask takes


class AtomicFile:
    """A file that is written under a temporary name. Its context removes it without commit()."""

    def __init__(self, directory: int, name: str, shown: PathLike, replace: bool) -> None:
        """
        Create the temporary file for a name in an open directory, and own the descriptor.

        shown is the target as messages name it; replace allows a regular file in its place.
        WriteError says why it cannot be written.
        """
        self._directory = directory
        self._name = name
        self._shown = shown
        self._replace = replace
        self._temporary: str | None = None
        try:
            check_target(name, shown, replace, directory)
            with guard(shown):
                temporary = temporary_name()
                self._file = os.fdopen(self._open_new(temporary), 'wb')
                self._temporary = temporary
        except BaseException:
            os.close(directory)
            raise

    def write(self, data: bytes) -> None:
        """Append data; WriteError if there is no room."""
        with guard(self._shown):
            self._file.write(data)

    def commit(self) -> None:
        """Give the complete file its name; WriteError if that is not possible any more."""
        with guard(self._shown):
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
        # Replacing would remove a device or a link that another program has made meanwhile.
        check_target(self._name, self._shown, self._replace, self._directory)
        if self._replace:
            self._rename()
            return
        self._claim()
        try:
            self._rename()
        except BaseException:
            os.unlink(self._name, dir_fd=self._directory)
            raise

    def close(self) -> None:
        """Close the file, and remove it unless it was committed."""
        with contextlib.suppress(OSError):      # its last bytes may have no room
            self._file.close()
        if self._temporary is not None:
            with contextlib.suppress(OSError):
                os.unlink(self._temporary, dir_fd=self._directory)
            self._temporary = None
        if self._directory >= 0:
            os.close(self._directory)
            self._directory = -1

    def __enter__(self) -> 'AtomicFile':
        """Return the file itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def _open_new(self, name: str) -> int:
        return os.open(name, _NEW, _MODE, dir_fd=self._directory)

    def _claim(self) -> None:
        # Renaming replaces anything; only creating fails if something is there.
        with guard(self._shown):
            try:
                os.close(self._open_new(self._name))
            except FileExistsError as error:
                raise already_exists(self._shown) from error

    def _rename(self) -> None:
        with guard(self._shown):
            assert self._temporary is not None, 'committed twice'
            os.replace(self._temporary, self._name,
                       src_dir_fd=self._directory, dst_dir_fd=self._directory)
            self._temporary = None


def atomic_file(path: PathLike, replace: bool = False) -> AtomicFile:
    """
    Create the temporary file for a path that the user named; WriteError if it cannot be written.

    A symbolic link is followed to the regular file it leads to.
    """
    with guard(path):
        parent, name = named_target(path)
        return AtomicFile(os.open(parent, _DIRECTORY), name, path, replace)


def atomic_file_inside(root: PathLike, path: PathLike, shown: PathLike,
                       replace: bool = False) -> AtomicFile:
    """
    Create the temporary file for a path that must be inside a directory, where nothing leads out.

    The path is relative to the root, or absolute; its symbolic links may lead to other directories
    inside, but the target itself may not be one. WriteError if it cannot be written.
    """
    with guard(shown):
        top = os.path.realpath(root)
        parent, name = split_target(os.path.join(top, path))
        inside = os.path.realpath(parent)
        if os.path.commonpath([top, inside]) != top:
            raise WriteError(f'cannot write {printable(shown)}: it must be inside '
                             f'{printable(top)}')
        return AtomicFile(_open_beneath(top, os.path.relpath(inside, top)), name, shown, replace)


def write_atomic(path: PathLike, data: bytes, replace: bool = False) -> None:
    """Write a file that appears complete or not at all; WriteError if it cannot be written."""
    with atomic_file(path, replace) as file:
        file.write(data)
        file.commit()


def _open_beneath(top: str, inside: str) -> int:
    """Open a directory beneath another without following links, which may be set meanwhile."""
    directory = os.open(top, _DIRECTORY)
    for part in inside.split(os.sep):
        above = directory
        try:
            directory = os.open(part, _DIRECTORY | os.O_NOFOLLOW, dir_fd=above)
        finally:
            os.close(above)
    return directory
