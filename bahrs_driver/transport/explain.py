# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Why a port cannot be used, in one sentence with a remedy.

Explaining looks at the system once more, which may fail in its own way. So everything here is
behind one guard: an error that cannot be explained is still reported.
"""

from collections.abc import Callable
import errno
import grp
import os
import pwd
import shlex
import socket
import stat
import termios
from typing import NamedTuple

from bahrs_driver.errors import DeviceNotFound, LinkError
from bahrs_driver.process.printable import printable
from bahrs_driver.transport.processes import holders, Process
from bahrs_driver.transport.tcp import CONNECT_TIMEOUT, ConnectionClosed, DEAD_AFTER

ABSENT = (errno.ENOENT, errno.ENXIO, errno.ENODEV)
IN_USE = (errno.EBUSY, errno.EAGAIN)
FORBIDDEN = (errno.EACCES, errno.EPERM)
NO_MORE_FILES = (errno.EMFILE, errno.ENFILE)
UNREACHABLE = (errno.EHOSTUNREACH, errno.ENETUNREACH, errno.EHOSTDOWN, errno.ENETDOWN)
MOST_NAMED = 3          # programs in one message
PSEUDO_TERMINALS = range(136, 144)      # major numbers

MISSING = '{name} does not exist: plug the device in, or name another port'
GONE = '{name} is gone: plug it in again, the driver will find it'
NOT_IN_GROUP = ('{name} may not be opened by user {user}: join its group with "sudo usermod -aG '
                '{group} {user}" and log in again')
IN_USE_BY = '{name} is in use by another program{holders}: see {command}'
CONNECTION_LOST = '{server} is gone: {why_lost}; the driver goes on trying'
# What is wrong with a port, for the table in the README.
CAUSES = {'a missing port': MISSING, 'a port that was pulled out': GONE,
          'a port that the user may not open': NOT_IN_GROUP, 'a port in use': IN_USE_BY,
          'a serial server that lost power': CONNECTION_LOST}


class Target(NamedTuple):
    """The port that an error is about."""

    name: str               # safe to show
    path: str               # of the device; empty for a server
    baud_rate: int
    was_open: bool          # earlier in this run


def why_not_open(target: Target, error: Exception) -> LinkError:
    """Return why a port cannot be opened, whatever the error is."""
    return _guarded(_why_no_server if not target.path else _why_no_device, target, error,
                    f'{target.name} cannot be opened: {plain(error)}')


def why_gone(target: Target, error: Exception) -> LinkError:
    """Return why a port that was open cannot be read any more."""
    if target.path:
        return _gone(target)
    return LinkError(CONNECTION_LOST.format(server=target.name, why_lost=_why_lost(error)),
                     absent=True)


def why_not_written(target: Target, error: Exception) -> LinkError:
    """Return why a port does not take data."""
    return LinkError(f'{target.name} does not take data: {plain(error)}')


def described(process: Process) -> str:
    """Return the name and number of a process, safe to show."""
    this = ', which is this one' if process.pid == os.getpid() else ''
    return f'{printable(process.name, 40)}, process {process.pid}{this}'


def list_command(path: str) -> str:
    """Return the command that lists the programs that have a device open."""
    return f'"fuser -v {shlex.quote(printable(path))}"'


def plain(error: BaseException) -> str:
    """Return what an exception says, on one line and without numbers of errors."""
    try:
        # pyserial puts the cause's text, errno and all, at the end of a sentence of its own.
        text = getattr(error, 'strerror', None) or str(error)
        return printable(text.rpartition('] ')[2], 200) or type(error).__name__
    except Exception:
        return type(error).__name__


def _guarded(explain: Callable[[Target, Exception], LinkError], target: Target,
             error: Exception, otherwise: str) -> LinkError:
    try:
        return explain(target, error)
    except Exception:
        return LinkError(otherwise)


def _gone(target: Target) -> LinkError:
    return LinkError(GONE.format(name=target.name), absent=True)


def _why_no_device(target: Target, error: Exception) -> LinkError:
    name, code = target.name, _code(error)
    if code in ABSENT:
        return _gone(target) if target.was_open else LinkError(
            MISSING.format(name=name), absent=True)
    if code in FORBIDDEN:
        return LinkError(_why_forbidden(target))
    if code in IN_USE:
        return LinkError(_why_in_use(target))
    if code in NO_MORE_FILES:
        return LinkError(f'{name} cannot be opened: too many files are open; close some, or '
                         'raise the limit with "ulimit -n"')
    if code == errno.EIO:
        return LinkError(f'{name} has no working hardware: plug the device in again, or name '
                         'another port')
    if code == errno.ENOTTY or not _is_character_device(target.path):
        return LinkError(f'{name} is not a serial port: name a device such as /dev/ttyUSB0')
    if code in (None, errno.EINVAL, errno.ERANGE):
        return LinkError(f'{name} does not support {target.baud_rate} baud: set baud_rate to '
                         'that of the device')
    return LinkError(f'{name} cannot be opened: {plain(error)}; "bahrs doctor --port '
                     f'{shlex.quote(printable(target.path))}" looks for the reason')


def _why_forbidden(target: Target) -> str:
    user = _user_name(os.geteuid())
    sentence = f'{target.name} may not be opened by user {user}'
    folder = _closed_folder(target.path)
    if folder:
        return (f'{sentence}: they may not enter {printable(folder)}, whose mode is '
                f'{stat.filemode(os.stat(folder).st_mode)}')
    info = os.stat(target.path)
    if info.st_gid and info.st_mode & stat.S_IRGRP and info.st_mode & stat.S_IWGRP:
        return NOT_IN_GROUP.format(name=target.name, group=_group_name(info.st_gid), user=user)
    return (f'{sentence}: its mode is {stat.filemode(info.st_mode)}, a udev rule with '
            'MODE="0660", GROUP="dialout" would let the group dialout use it')


def _closed_folder(path: str) -> str:
    """Return the first folder on the way to a path that may not be entered; '' if none."""
    way = os.path.dirname(os.path.abspath(path))
    folders = [way]
    while (parent := os.path.dirname(way)) != way:
        folders.append(way := parent)
    return next((folder for folder in reversed(folders) if not os.access(folder, os.X_OK)), '')


def _why_in_use(target: Target) -> str:
    found = holders(os.path.realpath(target.path))
    if not found and _is_pseudo_terminal(target.path):
        return (f'{target.name} is in use by another program, or by one that was killed: restart '
                'the program that made this pseudo-terminal')
    names = ', '.join(map(described, found[:MOST_NAMED]))
    return IN_USE_BY.format(name=target.name, holders=names and f' ({names})',
                            command=list_command(target.path))


def _why_no_server(target: Target, error: Exception) -> LinkError:
    name, code, text = target.name, _code(error), str(error)
    if isinstance(error, DeviceNotFound):
        return _gone(target) if target.was_open else LinkError(
            f'{name} cannot be opened: no device matches; plug it in, or see what there is with '
            '"python3 -m serial.tools.list_ports -v"', absent=True)
    if _caused_by(error, socket.gaierror):
        reason = 'no such host is known; check its name and the network'
    elif _caused_by(error, TimeoutError) or code == errno.ETIMEDOUT:
        reason = (f'its host has not answered for {CONNECT_TIMEOUT:g} s; check its power and the '
                  'network')
    elif code in UNREACHABLE or 'route to host' in text or 'unreachable' in text:
        reason = 'its host cannot be reached; check its power and the network'
    elif code == errno.ECONNREFUSED or 'refused' in text:
        reason = 'Connection refused; is the serial server running, and is this its TCP port?'
    elif 'RFC2217' in text or 'waiting for option' in text or 'rejected value' in text:
        reason = (f'the server does not accept RFC 2217 with {target.baud_rate} baud; for a plain '
                  'TCP port use socket://')
    else:
        reason = f'{plain(error)}; check the serial server and the network'
    return LinkError(f'{name} cannot be opened: {reason}', absent=True)


def _why_lost(error: Exception) -> str:
    code = _code(error)
    if isinstance(error, ConnectionClosed):
        return 'the other end closed the connection'
    if code == errno.ETIMEDOUT:
        return (f'the other end of the connection has not answered for {DEAD_AFTER} s, check its '
                'power and the network')
    if code in UNREACHABLE:
        return 'the other end of the connection cannot be reached, check the network'
    if code == errno.ECONNRESET:
        return 'the other end reset the connection'
    return (f'the connection was closed, or its other end has not answered for {DEAD_AFTER} s, '
            'check its power and the network')


def _code(error: BaseException) -> int | None:
    """Return the errno of an error, or of what pyserial made it from."""
    for each in _causes(error):
        code = getattr(each, 'errno', None)
        if code is None and isinstance(each, termios.error) and each.args:
            code = each.args[0]
        if isinstance(code, int):
            return code
    return None


def _caused_by(error: BaseException, kind: type[BaseException]) -> bool:
    return any(isinstance(each, kind) for each in _causes(error))


def _causes(error: BaseException) -> list[BaseException]:
    found: list[BaseException] = [error]
    while (cause := found[-1].__cause__ or found[-1].__context__) and cause not in found:
        found.append(cause)
    return found


def _is_character_device(path: str) -> bool:
    try:
        return stat.S_ISCHR(os.stat(path).st_mode)
    except OSError:
        return False


def _is_pseudo_terminal(path: str) -> bool:
    try:
        return os.major(os.stat(path).st_rdev) in PSEUDO_TERMINALS
    except OSError:
        return False


def _user_name(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return str(uid)


def _group_name(gid: int) -> str:
    try:
        return grp.getgrgid(gid).gr_name
    except KeyError:
        return str(gid)
