# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Ports that pyserial implements: RFC 2217 servers, and a loop for tests."""

import contextlib
import queue
import sys
import time
from typing import Any

from bahrs_driver.process.host_time import host_instant
from bahrs_driver.transport.channel import Reading
from bahrs_driver.transport.tcp import detect_loss
from bahrs_driver.transport.waker import Waker
import serial
from serial import rfc2217

SLICE = 0.1             # s from one check of the waker to the next
WRITE_TIMEOUT = 1.0     # s
LONGEST_QUEUE = 65536   # bytes received and not yet read


class PyserialChannel:
    """An open port of pyserial that has no descriptor for poll()."""

    stolen = 0

    def __init__(self, port: Any) -> None:
        self._port = port
        self._port.timeout = SLICE

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all; None after timeout seconds, or if woken."""
        deadline = time.monotonic() + timeout
        while not waker.clear():
            data: bytes = self._port.read(1)
            if data:
                waiting = self._port.in_waiting
                now = host_instant()
                return Reading(data + self._port.read(waiting) if waiting else data, now)
            if time.monotonic() >= deadline:
                break
        return None

    def write(self, data: bytes, _timeout: float, _waker: Waker) -> None:
        """Send all of data within WRITE_TIMEOUT seconds."""
        self._port.write(data)

    def close(self) -> None:
        """Close the port."""
        self._port.close()


_Client: Any = rfc2217.Serial       # its private attributes have no types


class Rfc2217Port(_Client):  # type: ignore[misc]
    """The client of pyserial, with limits on memory and time that a server can cost."""

    def open(self) -> None:  # noqa: A003 (as pyserial has it)
        """Connect, negotiate, and detect the loss of the server from then on."""
        super().open()
        detect_loss(self._socket)
        self._socket.settimeout(WRITE_TIMEOUT)

    def close(self) -> None:
        """Close the port, even while its reader thread waits for room in the queue."""
        pending = self._read_buffer
        if pending is not None:
            pending.maxsize = sys.maxsize
            with pending.mutex:
                pending.not_full.notify_all()
        super().close()

    def _telnet_read_loop(self) -> None:
        # Data from a server can make it raise, and pyserial would print the traceback.
        self._read_buffer.maxsize = LONGEST_QUEUE
        try:
            with contextlib.suppress(Exception):
                super()._telnet_read_loop()
        finally:
            self._end_of_stream()

    def _end_of_stream(self) -> None:
        with contextlib.suppress(queue.Full):
            self._read_buffer.put_nowait(None)


def open_rfc2217(url: str, baud_rate: int) -> PyserialChannel:
    """Open a port of an RFC 2217 server."""
    port = Rfc2217Port(None, baud_rate)     # pyserial refuses a write timeout here
    port.port = url
    port.open()
    return PyserialChannel(port)


def open_loop(url: str, baud_rate: int) -> PyserialChannel:
    """Open a port that returns the bytes written to it."""
    return PyserialChannel(serial.serial_for_url(
        url, baud_rate, write_timeout=WRITE_TIMEOUT))
