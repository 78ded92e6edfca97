# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check targets before they are written, and explain errors of the file system."""

from collections.abc import Iterator
import contextlib
import errno
import os
from pathlib import Path
import secrets
import stat

from bahrs_driver.errors import TargetExists, WriteError
from bahrs_driver.process.printable import printable

PathLike = str | Path
SHARED_MEMORY = '/dev/shm/'     # the only directory below /dev for files
ANOTHER = 'choose another directory'
REMEDIES = {
    errno.ENOENT: 'create its directory first',
    errno.EACCES: ANOTHER, errno.EPERM: ANOTHER, errno.EROFS: ANOTHER, errno.EFBIG: ANOTHER,
    errno.ENOSPC: f'free some space, or {ANOTHER}',
    errno.EDQUOT: f'free some space, or {ANOTHER}',
    errno.ENAMETOOLONG: 'choose a shorter name',
    errno.ELOOP: 'name the file itself, not a link',
}
KINDS = {
    stat.S_IFDIR: 'a directory', stat.S_IFLNK: 'a symbolic link', stat.S_IFIFO: 'a FIFO',
    stat.S_IFSOCK: 'a socket', stat.S_IFCHR: 'a character device', stat.S_IFBLK: 'a block device'}


def already_exists(target: PathLike) -> TargetExists:
    """Return the exception for a target that must not be replaced."""
    return TargetExists(f'{printable(target)} exists already: choose another name')


@contextlib.contextmanager
def guard(target: PathLike, verb: str = 'write') -> Iterator[None]:
    """Convert every exception in the block, which writes a target, to a WriteError."""
    try:
        yield
    except WriteError:
        raise
    except Exception as error:
        raise WriteError(sentence(error, target, verb)) from error


@contextlib.contextmanager
def guard_new(target: PathLike, verb: str = 'write') -> Iterator[None]:
    """Do what guard does for a block that creates a target; TargetExists if it exists."""
    with guard(target, verb):
        try:
            yield
        except FileExistsError as error:
            raise already_exists(target) from error


def check_target(name: str, shown: PathLike, replace: bool, directory: int | None = None) -> None:
    """
    Raise WriteError unless a target is absent or, with replace, a regular file.

    The name is relative to an open directory, if one is given. Links are not followed.
    """
    with guard(shown):
        try:
            mode = os.stat(name, dir_fd=directory, follow_symlinks=False).st_mode
        except FileNotFoundError:
            return
        if not stat.S_ISREG(mode):
            raise WriteError(f'cannot write {printable(shown)}: it is '
                             f'{KINDS.get(stat.S_IFMT(mode), "no file")}, and only regular files '
                             'are written')
        if not replace:
            raise already_exists(shown)


def split_target(path: PathLike) -> tuple[str, str]:
    """Split a target into directory and name; WriteError if it cannot be a file."""
    parent, name = os.path.split(os.fspath(path))
    if name in ('', os.curdir, os.pardir):
        raise WriteError(f'cannot write {printable(path)}: it is a directory: name a file in it'
                         if parent or name else 'cannot write a file without a name')
    refuse_new_device(path)
    return parent or os.curdir, name


def refuse_new_device(path: PathLike) -> None:
    """Raise WriteError for a new name in /dev, where a device may appear under that name."""
    with guard(path):
        where = os.path.join(os.path.realpath(os.path.dirname(path)), '')
        if where.startswith('/dev/') and not where.startswith(SHARED_MEMORY) \
                and not os.path.lexists(path):
            raise WriteError(f'cannot write {printable(path)}: /dev is for devices, choose a '
                             'directory elsewhere')


def named_target(path: PathLike) -> tuple[str, str]:
    """
    Split a path that the user named into directory and name; WriteError if it cannot be a file.

    A symbolic link is resolved to its file.
    """
    with guard(path):
        if not os.path.islink(path):
            return split_target(path)
        try:
            return split_target(os.path.realpath(path, strict=True))
        except FileNotFoundError as error:
            raise WriteError(f'cannot write {printable(path)}: it is a symbolic link to a file '
                             'that does not exist') from error


def temporary_name() -> str:
    """Return a unique hidden name, short enough for every file system."""
    return f'.bahrs_{secrets.token_hex(8)}.partial'


def sentence(error: Exception, target: PathLike, verb: str = 'write') -> str:
    """Explain in a sentence why a target cannot be written."""
    if isinstance(error, WriteError):
        return str(error)
    return f'cannot {verb} {printable(target)}: {reason(error)}'


def reason(error: Exception) -> str:
    """Explain an exception, with the remedy."""
    if isinstance(error, OSError):
        remedy = REMEDIES.get(error.errno or 0)
        return printable(error.strerror or error) + (f': {remedy}' if remedy else '')
    if isinstance(error, UnicodeError):
        return 'the name is not valid text: choose another'
    return printable(error)
