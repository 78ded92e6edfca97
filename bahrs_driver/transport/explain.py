# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Explain in one sentence why a port cannot be used, with a remedy.

An explanation reads the state of the system again, which may fail, too: an error that cannot be
explained is still reported.
"""

import errno
import os
import shlex
import socket
import stat
import termios
from typing import NamedTuple

from bahrs_driver.errors import DeviceNotFound, LinkError
from bahrs_driver.process.printable import printable
from bahrs_driver.transport.machine import Machine
from bahrs_driver.transport.port_access import access_advice
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
FORBIDDEN_TO_USER = ('{name} may not be opened by user {user}: {reason}; {remedy}: '
                     '"{access_command}"')
IN_USE_BY = '{name} is in use by another program{holders}: see {command}'
CONNECTION_LOST = '{server} is gone: {why_lost}; the driver goes on trying'
# Causes for the table in the README.
CAUSES = {'a missing port': MISSING, 'a port that was pulled out': GONE,
          'a port that the user may not open': FORBIDDEN_TO_USER, 'a port in use': IN_USE_BY,
          'a serial server that lost power': CONNECTION_LOST}


class Target(NamedTuple):
    """The port that an error is about."""

    name: str               # in printable form
    path: str               # of the device; empty for a server
    baud_rate: int
    was_open: bool          # earlier in this run


def why_not_open(target: Target, error: Exception) -> LinkError:
    """Return why a port cannot be opened. Never raise."""
    try:
        return _why_no_device(target, error) if target.path else _why_no_server(target, error)
    except Exception:
        return LinkError(f'{target.name} cannot be opened: {error_text(error)}')


def why_gone(target: Target, error: Exception) -> LinkError:
    """Return why a port was lost while it was open."""
    if target.path:
        return _gone(target)
    return LinkError(CONNECTION_LOST.format(server=target.name, why_lost=_why_lost(error)),
                     absent=True)


def why_not_written(target: Target, error: Exception) -> LinkError:
    """Return why a port does not accept data."""
    return LinkError(f'{target.name} does not take data: {error_text(error)}')


def describe_process(process: Process) -> str:
    """Describe a process by its name and id, in printable form."""
    this = ', which is this one' if process.pid == os.getpid() else ''
    return f'{printable(process.name, 40)}, process {process.pid}{this}'


def list_command(path: str) -> str:
    """Return the command that lists the programs that have a device open."""
    return f'"fuser -v {shlex.quote(printable(path))}"'


def error_text(error: BaseException) -> str:
    """Return the text of an exception on one line, without its errno. Never raise."""
    try:
        # pyserial ends its own sentence with the cause: "could not open port x: [Errno 5] ...".
        text = getattr(error, 'strerror', None) or str(error)
        return printable(text.rpartition('] ')[2], 200) or type(error).__name__
    except Exception:
        return type(error).__name__


def _gone(target: Target) -> LinkError:
    return LinkError(GONE.format(name=target.name), absent=True)


def _why_no_device(target: Target, error: Exception) -> LinkError:
    name, code = target.name, _code(error)
    if code in ABSENT:
        return _gone(target) if target.was_open else LinkError(
            MISSING.format(name=name), absent=True)
    if code in FORBIDDEN:
        return LinkError(_why_forbidden(target, error))
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
    return LinkError(_cannot_open(target, error))


def _cannot_open(target: Target, error: Exception) -> str:
    return (f'{target.name} cannot be opened: {error_text(error)}; "bahrs doctor --port '
            f'{shlex.quote(printable(target.path))}" looks for the reason')


def _why_forbidden(target: Target, error: Exception) -> str:
    machine = Machine()
    advice = access_advice(machine, os.path.abspath(target.path))
    if advice is None:
        return _cannot_open(target, error)
    return FORBIDDEN_TO_USER.format(
        name=target.name, user=machine.user.name, reason=advice.reason, remedy=advice.remedy,
        access_command=advice.command)


def _why_in_use(target: Target) -> str:
    found = holders(os.path.realpath(target.path))
    if not found and _is_pseudo_terminal(target.path):
        return (f'{target.name} is in use by another program, or by one that was killed: restart '
                'the program that made this pseudo-terminal')
    names = ', '.join(map(describe_process, found[:MOST_NAMED]))
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
        reason = f'{error_text(error)}; check the serial server and the network'
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
    """Return the errno of an error or, since pyserial drops it, of one of its causes."""
    for cause in _causes(error):
        code = getattr(cause, 'errno', None)
        if code is None and isinstance(cause, termios.error) and cause.args:
            code = cause.args[0]
        if isinstance(code, int):
            return code
    return None


def _caused_by(error: BaseException, kind: type[BaseException]) -> bool:
    return any(isinstance(cause, kind) for cause in _causes(error))


def _causes(error: BaseException) -> list[BaseException]:
    """Return an error and its causes, latest first; a chain may be circular."""
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
