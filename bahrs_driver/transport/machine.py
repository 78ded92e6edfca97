# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read the state of the computer from the files below /dev, /sys, /proc and /run.

Another folder can be the root of these files: tests make up any state of a machine.
"""

from collections.abc import Iterator, Mapping
import grp
import os
from pathlib import Path
import pwd
from typing import NamedTuple

from bahrs_driver.transport.processes import holders, Process, processes


class User(NamedTuple):
    """A user of the computer."""

    name: str
    uid: int
    groups: frozenset[int]          # of this session


def current_user() -> User:
    """Return the user of this process."""
    uid = os.geteuid()
    try:
        name = pwd.getpwuid(uid).pw_name
    except KeyError:
        name = str(uid)
    return User(name, uid, frozenset([os.getegid(), *os.getgroups()]))


class Machine:
    """Reads files, devices and processes below a root, on behalf of a user."""

    def __init__(self, root: Path = Path('/'), user: User | None = None,
                 environment: Mapping[str, str] = os.environ) -> None:
        self.root = root
        self.user = user or current_user()
        self.environment = environment

    def path(self, name: str) -> Path:
        """Return the path of a file of the machine below the root."""
        return self.root / name.lstrip('/')

    def read(self, name: str) -> str | None:
        """Return the text of a file; None if it is absent or not readable."""
        try:
            return self.path(name).read_text(errors='replace').strip()
        except OSError:
            return None

    def names(self, folder: str) -> list[str]:
        """Return the full names of the entries of a folder; none if there is no such folder."""
        try:
            return sorted(f'{folder}/{name}' for name in os.listdir(self.path(folder)))
        except OSError:
            return []

    def resolved(self, name: str) -> str:
        """Return the name of the file that links lead to."""
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
        """Return whether the group database lists the user, even if the session does not."""
        try:
            return self.user.name in grp.getgrgid(gid).gr_mem
        except KeyError:
            return False

    def processes(self) -> Iterator[Process]:
        """Return all processes."""
        return processes(self.root)

    def holders(self, device: str) -> list[Process]:
        """Return the other processes that have a device open, as far as the user may see them."""
        return [process for process in holders(device, self.root)
                if process.pid != os.getpid()]

    def all_visible(self) -> bool:
        """Return whether the user may see the open files of every process."""
        return self.user.uid == 0
