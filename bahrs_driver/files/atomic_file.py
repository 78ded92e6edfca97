# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Files that appear complete or not at all.

The data goes into a temporary file beside the target, and commit() renames it. Create the file
before the work that produces the data: a directory that is not writable is then reported first.
The directory stays open meanwhile. If another program moves the directory or puts a symbolic link
in its path, the data is still written to the directory that was checked.
"""

import contextlib
import os

from bahrs_driver.errors import WriteError
from bahrs_driver.files.guard import (
    check_target, guard, guard_new, named_target, PathLike, split_target, temporary_name)
from bahrs_driver.process.printable import printable

_DIRECTORY = os.O_PATH | os.O_DIRECTORY | os.O_CLOEXEC
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
_MODE = 0o666               # less what the umask takes


class AtomicFile:
    """A file with a temporary name until commit(); without commit(), close() removes it."""

    def __init__(self, directory: int, name: str, shown: PathLike, replace: bool) -> None:
        """
        Create the temporary file; WriteError if the target cannot be written.

        directory is the descriptor of the target's directory, which close() closes. name is the
        target's name in it, shown its path in messages. With replace, it may be a regular file.
        """
        self._directory = directory
        self._name = name
        self._shown = shown
        self._replace = replace
        self._temporary = ''                # its name, while it exists
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
        """Rename the complete file to its target; WriteError if that has become impossible."""
        with guard_new(self._shown), contextlib.ExitStack() as on_failure:
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
            # Renaming would remove a device or a link that another program has created meanwhile.
            check_target(self._name, self._shown, self._replace, self._directory)
            if not self._replace:           # unlike renaming, creating fails if the target exists
                os.close(self._open_new(self._name))
                on_failure.callback(os.unlink, self._name, dir_fd=self._directory)
            os.replace(self._temporary, self._name,
                       src_dir_fd=self._directory, dst_dir_fd=self._directory)
            on_failure.pop_all()
        self._temporary = ''

    def close(self) -> None:
        """Close the file, and remove it unless it was committed."""
        with contextlib.suppress(OSError):      # no room for its last bytes
            self._file.close()
        if self._temporary:
            with contextlib.suppress(OSError):
                os.unlink(self._temporary, dir_fd=self._directory)
            self._temporary = ''
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
    Create the temporary file for a path that must stay inside a root directory.

    The path is absolute, or relative to the root. Symbolic links in it may lead to other
    directories inside the root; the target itself may not be a link. WriteError if it cannot be
    written.
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
    """Open a directory beneath another; OSError if a part of the path has become a link."""
    directory = os.open(top, _DIRECTORY)
    for part in inside.split(os.sep):
        parent = directory
        try:
            directory = os.open(part, _DIRECTORY | os.O_NOFOLLOW, dir_fd=parent)
        finally:
            os.close(parent)
    return directory
