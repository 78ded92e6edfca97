# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The computer, as the files below /dev, /sys, /proc and /run tell of it.

The root of these files can be another folder, so that every state of a machine can be made up.
"""

from collections.abc import Iterator, Mapping
import grp
import os
from pathlib import Path
import pwd
from typing import NamedTuple

from bahrs_driver.transport.processes import holders, Process, processes


class User(NamedTuple):
    """Whoever would open a port."""

    name: str
    uid: int
    groups: frozenset[int]          # of this session


def present_user() -> User:
    """Return who runs this process."""
    uid = os.geteuid()
    try:
        name = pwd.getpwuid(uid).pw_name
    except KeyError:
        name = str(uid)
    return User(name, uid, frozenset([os.getegid(), *os.getgroups()]))


class Machine:
    """Answers questions about devices and processes."""

    def __init__(self, root: Path = Path('/'), user: User | None = None,
                 environment: Mapping[str, str] = os.environ) -> None:
        self.root = root
        self.user = user or present_user()
        self.environment = environment

    def path(self, name: str) -> Path:
        """Return where a file of the machine really is."""
        return self.root / name.lstrip('/')

    def read(self, name: str) -> str | None:
        """Return the text of a file; None if there is none that may be read."""
        try:
            return self.path(name).read_text(errors='replace').strip()
        except OSError:
            return None

    def names(self, folder: str) -> list[str]:
        """Return the full names of what is in a folder; none if there is no such folder."""
        try:
            return sorted(f'{folder}/{name}' for name in os.listdir(self.path(folder)))
        except OSError:
            return []

    def resolved(self, name: str) -> str:
        """Return the name of what links lead to."""
        target = os.path.realpath(self.path(name))
        root = os.path.realpath(self.root)
        return '/' + os.path.relpath(target, root)

    def group_name(self, gid: int) -> str:
        """Return the name of a group."""
        try:
            return grp.getgrgid(gid).gr_name
        except KeyError:
            return str(gid)

    def is_member(self, gid: int) -> bool:
        """Return whether the user is in a group by the files, if not in this session."""
        try:
            return self.user.name in grp.getgrgid(gid).gr_mem
        except KeyError:
            return False

    def processes(self) -> Iterator[Process]:
        """Return all processes."""
        return processes(self.root)

    def holders(self, device: str) -> list[Process]:
        """Return the processes that have a device open, as far as the user may see it."""
        return [process for process in holders(device, self.root)
                if process.pid != os.getpid()]

    def all_visible(self) -> bool:
        """Return whether the open files of every process can be seen."""
        return self.user.uid == 0
