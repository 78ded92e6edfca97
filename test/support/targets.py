# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Targets of every kind to write to, and what must have become of them."""

from collections.abc import Callable, Iterator
import contextlib
import os
from pathlib import Path
import resource
import socket
import stat

PRECIOUS = b'precious'
Make = Callable[[Path], object]      # puts something at a path


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as listener:
        here = os.open(path.parent, os.O_RDONLY)
        try:            # by the shortest path: that of a socket has little room
            listener.bind(f'/proc/self/fd/{here}/{path.name}')
        finally:
            os.close(here)


def _directory(path: Path) -> None:
    path.mkdir()
    (path / 'kept').write_bytes(PRECIOUS)


def _read_only(path: Path) -> None:
    path.write_bytes(PRECIOUS)
    path.chmod(0o400)


def _block_device(path: Path) -> None:
    try:            # of a driver that no machine has
        os.mknod(path, stat.S_IFBLK | 0o666, os.makedev(120, 99))
    except PermissionError:
        os.mkfifo(path)                 # only the superuser may, and not in every container


def _link_to(make: Make) -> Make:
    """Return what puts a link to what another function makes beside it."""
    def put(path: Path) -> None:
        aside = path.with_name(f'{path.name}_aside')
        make(aside)
        path.symlink_to(aside)
    return put


# What can be at a path, by what puts it there.
REGULAR: dict[str, Make] = {
    'regular': lambda path: path.write_bytes(PRECIOUS),
    'empty': lambda path: path.touch(),
    'read-only': _read_only,
}
NOT_REGULAR: dict[str, Make] = {
    'directory': _directory,
    'empty directory': lambda path: path.mkdir(),
    'FIFO': os.mkfifo,
    'socket': _socket,
    'character device': lambda path: path.symlink_to('/dev/full'),
    'terminal': lambda path: path.symlink_to('/dev/ptmx'),
    'block device': _block_device,
    'dangling link': lambda path: path.symlink_to(path.parent / 'nowhere'),
    'loop': lambda path: path.symlink_to(path),
}
EVERY_KIND = {**REGULAR, **NOT_REGULAR}
EVERY_KIND |= {f'link to {name}': _link_to(make) for name, make in EVERY_KIND.items()}
# Paths that cannot be written at all, relative to a directory that has a regular file `file`.
IMPOSSIBLE = {
    'missing parent': 'missing/target',
    'parent is a file': 'file/target',
    'name too long': 'x' * 300,
    'path too long': '/'.join(['y' * 200] * 30),
    'current directory': '.',
    'parent directory': '..',
    'trailing slash': 'target/',
    'no file system for files': '/proc/target',
    'NUL': 'a\0b',
    'lone surrogate': 'a\ud800b',
}


def snapshot(top: Path) -> dict[bytes, tuple[int, bytes | str | None]]:
    """Return all that is below a directory: kinds, links, and contents of regular files."""
    found: dict[bytes, tuple[int, bytes | str | None]] = {}
    for parent, directories, files in os.walk(top):
        for name in directories + files:
            path = Path(parent, name)
            mode = path.lstat().st_mode
            content = path.read_bytes() if stat.S_ISREG(mode) else \
                os.readlink(path) if stat.S_ISLNK(mode) else None
            found[os.fsencode(path.relative_to(top))] = mode, content
    return found


@contextlib.contextmanager
def no_larger_file_than(size: int) -> Iterator[None]:
    """Let writing fail beyond a size, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@contextlib.contextmanager
def umask(mask: int) -> Iterator[None]:
    """Set the umask for the length of a block."""
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


@contextlib.contextmanager
def unprivileged() -> Iterator[None]:
    """Give up the rights of the superuser, who may write everywhere, for the length of a block."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(0)
