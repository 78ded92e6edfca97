# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find out why a user may not open a device, and the command that permits it."""

import os
import shlex
import stat
from typing import NamedTuple

from bahrs_driver.process.printable import printable
from bahrs_driver.transport.machine import Machine


class AccessAdvice(NamedTuple):
    """Why a device may not be opened, and what to do."""

    reason: str
    remedy: str             # an imperative
    command: str            # the command for the remedy


def access_advice(machine: Machine, port: str) -> AccessAdvice | None:
    """Return why the user may not open a port; None if nothing forbids it. May raise OSError."""
    folder = _closed_folder(str(machine.path(port)))
    if folder:
        mode = stat.filemode(os.stat(folder).st_mode)
        return AccessAdvice(f'they may not enter {printable(folder)}, whose mode is {mode}',
                            'find the folder to open', f'namei -l {_quoted(port)}')
    info, user = os.stat(machine.path(port)), machine.user
    if user.uid == 0 or _may(info, stat.S_IROTH | stat.S_IWOTH) \
            or user.uid == info.st_uid and _may(info, stat.S_IRUSR | stat.S_IWUSR):
        return None
    if not _may(info, stat.S_IRGRP | stat.S_IWGRP):
        return AccessAdvice(
            f'its mode is {stat.filemode(info.st_mode)}',
            'let the group dialout use it (a udev rule does so permanently)',
            f'sudo chgrp dialout {_quoted(port)} && sudo chmod 660 {_quoted(port)}')
    if info.st_gid in user.groups:
        return None
    group = machine.group_name(info.st_gid)
    if machine.is_member(info.st_gid):
        return AccessAdvice(f'they joined group {group} after this session began',
                            'log in again, or go on in another shell',
                            f'newgrp {shlex.quote(group)}')
    return AccessAdvice(f'it belongs to group {group}', 'join the group and log in again',
                        f'sudo usermod -aG {shlex.quote(group)} {shlex.quote(user.name)}')


def _may(info: os.stat_result, bits: int) -> bool:
    return info.st_mode & bits == bits


def _closed_folder(path: str) -> str:
    """Return the first folder on the way to a path that may not be entered; '' if none."""
    folder = os.path.dirname(os.path.abspath(path))
    folders = [folder]
    while (parent := os.path.dirname(folder)) != folder:
        folders.append(folder := parent)
    return next((folder for folder in reversed(folders) if not os.access(folder, os.X_OK)), '')


def _quoted(path: str) -> str:
    return shlex.quote(printable(path))
