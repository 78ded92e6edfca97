# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""List processes, and those that have a device open, from /proc."""

from collections.abc import Iterator
import contextlib
import os
from pathlib import Path
from typing import NamedTuple

ROOT = Path('/')


class Process(NamedTuple):
    """A running process."""

    pid: int
    name: str


def processes(root: Path = ROOT) -> Iterator[Process]:
    """Yield all processes; root is the folder of /proc."""
    for pid in _pids(root):
        yield Process(pid, _name_of(pid, root))


def holders(device: str, root: Path = ROOT) -> list[Process]:
    """
    Return the processes that have a device open, given its resolved path.

    Only root sees those of other users.
    """
    return [Process(pid, _name_of(pid, root)) for pid in _pids(root)
            if device in _open_files(pid, root)]


def _pids(root: Path) -> list[int]:
    return sorted(int(name) for name in _names(root / 'proc') if name.isdigit())


def _names(folder: Path) -> list[str]:
    try:
        return os.listdir(folder)
    except OSError:             # none, not permitted, or the process has ended
        return []


def _open_files(pid: int, root: Path) -> Iterator[str]:
    folder = root / f'proc/{pid}/fd'
    for name in _names(folder):
        with contextlib.suppress(OSError):
            yield os.readlink(folder / name)


def _name_of(pid: int, root: Path) -> str:
    words = [os.path.basename(word)
             for word in _text(root / f'proc/{pid}/cmdline').split('\0') if word]
    if len(words) > 1 and words[0].startswith('python'):
        return words[1]
    return _text(root / f'proc/{pid}/comm') or (words or ['?'])[0]


def _text(file: Path) -> str:
    try:
        return file.read_text(errors='replace').strip()
    except OSError:
        return ''
