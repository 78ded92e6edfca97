# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The port: opened, read with the host's time, written, closed.

A port is a path or any pyserial URL. What goes wrong with it is told in one sentence that names
the port, the reason and the remedy, and is always a LinkError: the port may be back in a second.
"""

import contextlib
import errno
import grp
import os
import pwd
import stat
import termios
import threading
import time
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from bahrs_driver.clock import byte_time_ns, Instant
from bahrs_driver.host_time import paired_reading
from bahrs_driver.printable import printable
import serial

READ_TIMEOUT = 0.5      # s; bounds how long a closed-down link may hold its reader
WRITE_TIMEOUT = 1.0     # s
SOCKET_CHUNK = 4096     # bytes
_NO_LINE_RATE = ('ttyACM', 'ttyGS')


class LinkError(Exception):
    """The port cannot be used now. The text says why, and what can be done about it."""

    def __init__(self, reason: str, absent: bool = False) -> None:
        """Take the sentence, and whether the reason is that there is no such port."""
        super().__init__(reason)
        self.absent = absent


class Reading(NamedTuple):
    """The bytes of one read, and a moment when all of them had come; nearly the first such."""

    data: bytes
    now: Instant


def now() -> Instant:
    """Read both clocks of the host as if at once; the raw time is that of the call."""
    reading = paired_reading(time.CLOCK_MONOTONIC_RAW)
    return Instant(reading.time, reading.time + reading.offset)


class Link:
    """A port that can be opened again and again."""

    def __init__(self, port: str, baud_rate: int) -> None:
        """Take a path or pyserial URL; ValueError for a URL that can never be opened."""
        self.port = port
        self.baud_rate = baud_rate
        self._is_url = '://' in port
        self._is_socket = port.startswith('socket://')
        self._was_open = False
        self._closing = threading.Lock()
        if self._is_socket and not (urlsplit(port).hostname and urlsplit(port).port):
            raise ValueError('it must have a host and a port, such as socket://host:4001')
        try:
            self._serial = self._make()
        except OSError:             # hwgrep:// finds nothing yet
            self._serial = serial.Serial()

    @property
    def name(self) -> str:
        """Name of the port, safe to show and to log."""
        return printable(self.port)

    @property
    def is_open(self) -> bool:
        """Whether the port is open."""
        return bool(self._serial.is_open)

    @property
    def byte_time_ns(self) -> int:
        """Nanoseconds that a byte takes on the line; 0 for native USB and networks."""
        name = os.path.basename(os.path.realpath(self.port))
        no_rate = self._is_url or name.startswith(_NO_LINE_RATE)
        return 0 if no_rate else byte_time_ns(self.baud_rate)

    def connect(self) -> None:
        """Open the port for this process alone. LinkError says why it cannot be."""
        try:
            self._serial = self._make()
            self._serial.open()
        except (OSError, ValueError, termios.error) as error:
            raise self._why_not_open(error) from error
        self._was_open = True

    def read(self) -> Reading | None:
        """Wait for bytes and take all there are; None if none came in time, LinkError if gone."""
        try:
            return self._read_socket() if self._is_socket else self._read_port()
        except OSError as error:
            raise self._gone() from error

    def write(self, data: bytes) -> None:
        """Send all of data. LinkError if the port is gone or takes no more."""
        try:
            with self._closing:
                self._serial.write(data)
        except OSError as error:
            raise LinkError(f'{self.port} does not take data: {error}') from error

    def cancel_read(self) -> None:
        """Wake the thread that waits in read, if the port's kind allows it."""
        with self._closing:
            cancel = getattr(self._serial, 'cancel_read', None)
            if cancel is not None and self.is_open:
                cancel()

    def close(self) -> None:
        """Close the port. Closing one that is gone or closed does no harm."""
        with self._closing, contextlib.suppress(OSError):
            self._serial.close()

    def _make(self) -> Any:
        # Each time, for hwgrep:// looks for the device then and there.
        return serial.serial_for_url(
            self.port, baudrate=self.baud_rate, timeout=READ_TIMEOUT,
            write_timeout=WRITE_TIMEOUT, exclusive=True, do_not_open=True)

    def _read_port(self) -> Reading | None:
        # What an adapter hands over at once is one read, under one time: who wakes up for its
        # first byte and comes back for the others is late for them by all it did in between.
        first = b''
        if not self._serial.in_waiting:
            first = self._serial.read(1)
            if not first:
                return None
        try:
            waiting = self._serial.in_waiting
            moment = now()
            return Reading(first + self._serial.read(waiting) if waiting else first, moment)
        except OSError:             # the port is gone; the next read will say so
            if not first:
                raise
            return Reading(first, now())

    def _read_socket(self) -> Reading | None:
        # A socket cannot say how much is waiting: take the first byte, then all that is there.
        data: bytes = self._serial.read(1)
        if not data:
            return None
        self._serial.timeout = 0
        try:
            data += self._serial.read(SOCKET_CHUNK)
        except OSError:             # the other end has closed; the next read will say so
            pass
        finally:
            self._serial.timeout = READ_TIMEOUT
        return Reading(data, now())

    def _gone(self) -> LinkError:
        remedy = 'the driver goes on trying' if self._is_url \
            else 'plug it in again, the driver will find it'
        return LinkError(f'{self.name} is gone: {remedy}', absent=True)

    def _why_not_open(self, error: Exception) -> LinkError:
        code = getattr(error, 'errno', None)
        if self._is_url:
            return LinkError(f'{self.port} cannot be opened: {_plain(error)}')
        if code == errno.ENOENT and self._was_open:
            return self._gone()
        if code == errno.ENOENT:
            return LinkError(f'{self.port} does not exist: plug the device in, or name another '
                             'port', absent=True)
        if code in (errno.EACCES, errno.EPERM):
            return LinkError(self._why_forbidden())
        if code in (errno.EBUSY, errno.EAGAIN):
            return LinkError(f'{self.port} is in use by another program: '
                             f'"fuser -v {self.port}" tells which')
        if isinstance(error, (ValueError, termios.error)):
            return LinkError(f'{self.port} does not support {self.baud_rate} baud')
        if code is None or not _is_character_device(self.port):
            return LinkError(f'{self.port} is not a serial port')
        return LinkError(f'{self.port} cannot be opened: {_plain(error)}')

    def _why_forbidden(self) -> str:
        user = _user_name(os.geteuid())
        info = os.stat(self.port)
        if info.st_gid and info.st_mode & stat.S_IRGRP and info.st_mode & stat.S_IWGRP:
            return (f'{self.port} may not be opened by user {user}: join its group with '
                    f'"sudo usermod -aG {_group_name(info.st_gid)} {user}" and log in again')
        return (f'{self.port} may not be opened by user {user}: its mode is '
                f'{stat.filemode(info.st_mode)}, a udev rule with MODE="0660", GROUP="dialout" '
                'would let the group dialout use it')


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


def _is_character_device(path: str) -> bool:
    try:
        return stat.S_ISCHR(os.stat(path).st_mode)
    except OSError:
        return False


def _plain(error: Exception) -> str:
    # pyserial puts the cause's text, errno and all, at the end of a sentence of its own.
    return getattr(error, 'strerror', None) or str(error).rpartition('] ')[2]
