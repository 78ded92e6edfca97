# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A serial port made of a pseudo-terminal, seen from the device."""

import fcntl
import os
from pathlib import Path
import pty
import re
import select
import struct
import termios
import time
import tty

from bahrs_driver.files.guard import guard
from bahrs_driver.process.printable import printable

_PSEUDO_TERMINAL = re.compile('/dev/pts/[0-9]+')
_READ_SIZE = 4096
_READER_POLL_PERIOD = 0.02  # s between checks for a reader at the other end
_LOCKED_WAIT = 2.0          # s for a reader that has locked the port


class PtyPort:
    """
    The device's end of a pseudo-terminal; programs open the other end as a serial port.

    `path` is the port to open, `link` an optional symbolic link to it, which close() removes.
    """

    def __init__(self, link: str | None = None) -> None:
        """
        Create the port.

        A link is replaced only if it leads to a pseudo-terminal that is gone. FileExistsError if
        another file exists, OSError if the port cannot be created, WriteError if the link cannot.
        """
        self._link = Path(link) if link else None
        self._fd, far_end = pty.openpty()
        tty.setraw(far_end)
        os.set_blocking(self._fd, False)
        self.path = os.ttyname(far_end)
        # Closing it lets poll() show whether another program has it open.
        os.close(far_end)
        try:
            self._make_link()
        except BaseException:
            os.close(self._fd)
            raise

    @property
    def name(self) -> str:
        """Path for the user to open."""
        return str(self._link or self.path)

    @property
    def is_open(self) -> bool:
        """Whether a program has the port open."""
        return not self._poll(select.POLLHUP, 0.0)

    def wait_until_open(self, timeout: float | None = None) -> bool:
        """Wait until a program has the port open; False at the timeout in seconds."""
        waited = 0.0
        while not self.is_open:
            if timeout is not None and waited >= timeout:
                return False
            time.sleep(_READER_POLL_PERIOD)
            waited += _READER_POLL_PERIOD
        return True

    def wait_until_read(self, timeout: float) -> bool:
        """
        Wait until all bytes are read or the port is closed; False at the timeout in seconds.

        Bytes of the last moment may not be readable yet and are missed. If a reader has locked
        the port, wait for a fixed time instead.
        """
        waited = 0.0
        while self.is_open and (unread := self._count_unread()) != 0:
            if unread is None and waited >= min(timeout, _LOCKED_WAIT):
                return True
            if waited >= timeout:
                return False
            time.sleep(_READER_POLL_PERIOD)
            waited += _READER_POLL_PERIOD
        return True

    def _make_link(self) -> None:
        if not self._link:
            return
        if os.path.lexists(self._link):
            self._check_replaceable(self._link)
            self._link.unlink(missing_ok=True)
        with guard(self._link):
            self._link.symlink_to(self.path)

    def _check_replaceable(self, link: Path) -> None:
        """Raise FileExistsError unless the link is left over from a killed emulator."""
        if not link.is_symlink():
            raise FileExistsError(f'{printable(link)} exists and is not a symbolic link: choose '
                                  'another name')
        target = os.readlink(link)
        if not _PSEUDO_TERMINAL.fullmatch(target):
            raise FileExistsError(f'{printable(link)} leads to {printable(target)}, which is '
                                  'not a port of an emulator: choose another name')
        if target != self.path and link.exists():
            raise FileExistsError(f'{printable(link)} is the port of another program: end that, '
                                  'or remove the link')

    def _count_unread(self) -> int | None:
        """Return how many bytes are unread at the other end; None if it cannot be opened."""
        try:
            far_end = os.open(self.path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError:         # the reader has locked it, and we are not root
            return None
        try:
            count, = struct.unpack('i', fcntl.ioctl(far_end, termios.FIONREAD, bytes(4)))
        finally:
            os.close(far_end)
        return int(count)

    def _poll(self, events: int, timeout: float) -> bool:
        # Not select(), which fails on descriptors from 1024 on.
        poll = select.poll()
        poll.register(self._fd, events)
        return bool(poll.poll(timeout * 1e3))

    def write(self, data: bytes) -> None:
        """Send data; block while the reader is slow. Without a reader the data is lost."""
        while data and self.is_open:
            try:
                data = data[os.write(self._fd, data):]
            except BlockingIOError:
                self._poll(select.POLLOUT, _READER_POLL_PERIOD)

    def write_nowait(self, data: bytes) -> int:
        """Send data without blocking; return how many bytes were sent, all without a reader."""
        if not data or not self.is_open:
            return len(data)
        try:
            return os.write(self._fd, data)
        except BlockingIOError:
            return 0

    def fileno(self) -> int:
        """Return the descriptor that is readable when the host has sent bytes."""
        return self._fd

    def read(self, timeout: float = 0.0) -> bytes:
        """Return bytes of the host, waiting at most timeout seconds for the first."""
        if not self.is_open or not self._poll(select.POLLIN, timeout):
            return b''
        try:
            return os.read(self._fd, _READ_SIZE)
        except OSError:         # closed at the other end in the meantime
            return b''

    def close(self) -> None:
        """Remove the port, as unplugging an adapter does. Calling this again does nothing."""
        if self._fd < 0:
            return
        # The link first: after closing, another program may get the same path.
        if self._link and self._link.is_symlink() and os.readlink(self._link) == self.path:
            self._link.unlink()
        os.close(self._fd)
        self._fd = -1

    def __enter__(self) -> 'PtyPort':
        """Return the port itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self.close()
