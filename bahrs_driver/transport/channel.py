# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""An open port: its interface, and the implementation for ports with a file descriptor."""

import errno
import os
import select
import time
from typing import NamedTuple, Protocol

from bahrs_driver.clock import Instant
from bahrs_driver.process.host_time import host_instant
from bahrs_driver.transport.waker import Waker

LARGEST_READ = 4096     # bytes


class Reading(NamedTuple):
    """The bytes of one read, and the earliest known time by which all had arrived."""

    data: bytes
    now: Instant


class Channel(Protocol):
    """An open port. It raises OSError."""

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all; None after timeout seconds, or if woken."""

    def write(self, data: bytes, timeout: float, waker: Waker) -> None:
        """Send all of data within timeout seconds, unless woken."""

    def close(self) -> None:
        """Close the port."""

    @property
    def stolen(self) -> int:
        """Count of reads whose bytes another program had taken."""


class DescriptorChannel:
    """
    A port with a file descriptor.

    It uses poll(), because select() fails on descriptors from 1024 on.
    """

    stolen = 0

    def __init__(self, descriptor: int) -> None:
        """Use a descriptor, which its owner closes."""
        self._descriptor = descriptor
        os.set_blocking(descriptor, False)
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLIN)
        self._waker_polled = -1         # descriptor

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all; None after timeout seconds, or if woken."""
        self._register(waker.fileno())
        ready = self._poll.poll(timeout * 1e3)
        if not ready:
            return None
        if len(ready) > 1 or ready[0][0] != self._descriptor:
            waker.clear()
            return None
        # An adapter delivers bytes in blocks: read a whole block, with one time. A time from
        # before the read could be earlier than the last bytes.
        try:
            data = os.read(self._descriptor, LARGEST_READ)
        except BlockingIOError:
            self._handle_no_data()
            return None
        if data:
            return Reading(data, host_instant())
        self._handle_end_of_stream()
        return None

    def _register(self, waker: int) -> None:
        if waker != self._waker_polled:
            self._poll.register(waker, select.POLLIN)
            self._waker_polled = waker

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

    def _handle_no_data(self) -> None:
        """Handle a read without data after poll() announced some."""

    def _handle_end_of_stream(self) -> None:
        """Handle the end of the stream."""
