# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a Link needs of an open port, and the part of it that all descriptors share."""

import errno
import fcntl
import os
import select
import struct
import termios
import time
from typing import Protocol

from bahrs_driver.process.host_time import host_instant
from bahrs_driver.transport.reading import Reading
from bahrs_driver.transport.waker import Waker

LARGEST_READ = 4096     # bytes


class Channel(Protocol):
    """An open port. What goes wrong with it is an OSError."""

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all there are; None after timeout seconds, or if woken."""

    def write(self, data: bytes, timeout: float, waker: Waker) -> None:
        """Send all of data within timeout seconds, unless woken."""

    def close(self) -> None:
        """Close the port."""

    @property
    def stolen(self) -> int:
        """Count of reads that found the bytes taken by another program."""


class DescriptorChannel:
    """
    A port that is a descriptor.

    It is waited for with poll(), because select() fails on descriptors from 1024 on.
    """

    stolen = 0

    def __init__(self, descriptor: int) -> None:
        """Use a descriptor, which is closed by its owner."""
        self._descriptor = descriptor
        os.set_blocking(descriptor, False)

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all there are; None after timeout seconds, or if woken."""
        poll = select.poll()
        poll.register(self._descriptor, select.POLLIN)
        poll.register(waker.fileno(), select.POLLIN)
        if not poll.poll(timeout * 1e3) or waker.clear():
            return None
        # What an adapter hands over at once is one read, under one time. The time is taken after
        # the bytes are counted, or it would be too early for those that arrive meanwhile.
        count = min(self._count_waiting(), LARGEST_READ)
        moment = host_instant()
        try:
            data = os.read(self._descriptor, count or 1)
        except BlockingIOError:
            self._found_nothing()
            return None
        if not data:
            self._found_end()
            return None
        return Reading(data, moment)

    def write(self, data: bytes, timeout: float, waker: Waker) -> None:
        """Send all of data within timeout seconds, unless woken."""
        deadline = time.monotonic() + timeout
        while data:
            try:
                data = data[os.write(self._descriptor, data):]
            except BlockingIOError:
                self._wait_until_writable(deadline, timeout, waker)

    def _wait_until_writable(self, deadline: float, timeout: float, waker: Waker) -> None:
        remaining = deadline - time.monotonic()
        if remaining > 0:
            poll = select.poll()
            poll.register(self._descriptor, select.POLLOUT)
            poll.register(waker.fileno(), select.POLLIN)
            ready = [descriptor for descriptor, _ in poll.poll(remaining * 1e3)]
            if waker.fileno() in ready:
                raise OSError(errno.ECANCELED, 'the port is being closed')
            if ready:
                return
        raise TimeoutError(errno.ETIMEDOUT, f'it has accepted nothing for {timeout:g} s')

    def _count_waiting(self) -> int:
        return int(struct.unpack('i', fcntl.ioctl(
            self._descriptor, termios.FIONREAD, bytes(4)))[0])

    def _found_nothing(self) -> None:
        """React to bytes that were announced and are not there."""

    def _found_end(self) -> None:
        """React to the end of the stream."""
