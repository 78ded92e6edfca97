# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Open, read, write and close a port.

A port is the path of a device or a URL. One thread opens, reads and closes it; any thread may
write. Every failure is a LinkError, whose text is one sentence with the port, the reason and the
remedy. None is final: the port may be back in a second.
"""

from collections.abc import Callable
from functools import partial
import os
import threading

from bahrs_driver.process.printable import printable
from bahrs_driver.transport.address import check_baud_rate, parse_address
from bahrs_driver.transport.channel import Channel, Reading
from bahrs_driver.transport.device_search import find_device
from bahrs_driver.transport.explain import Target, why_gone, why_not_open, why_not_written
from bahrs_driver.transport.interruptible_call import InterruptibleCall
from bahrs_driver.transport.pyserial_url import open_loop, open_rfc2217
from bahrs_driver.transport.serial_port import SerialPort
from bahrs_driver.transport.tcp import TcpConnection
from bahrs_driver.transport.waker import Waker
from bahrs_driver.units import byte_time_ns

READ_TIMEOUT = 0.5      # s
WRITE_TIMEOUT = 1.0     # s
_NO_LINE_RATE = ('ttyACM', 'ttyGS')     # native USB, on which a baud rate has no effect


class Link:
    """A port that can be opened repeatedly."""

    def __init__(self, port: str, baud_rate: int) -> None:
        """Parse the path or URL; ValueError if it can never be opened."""
        self.port = port
        self.name = printable(port)
        self.baud_rate = baud_rate
        check_baud_rate(baud_rate)
        self._address = parse_address(port)
        self._path = '' if self._address.scheme else port
        self._channel: Channel | None = None
        self._was_open = False
        self._reader_waker, self._writer_waker = Waker(), Waker()
        self._writing = threading.Lock()

    @property
    def is_open(self) -> bool:
        """Whether the port is open."""
        return self._channel is not None

    @property
    def is_network(self) -> bool:
        """Whether the port is at the other end of a network connection."""
        return self._address.is_network

    @property
    def path(self) -> str:
        """Path of the device; empty for a server, and for a device not found yet."""
        return self._path

    @property
    def stolen(self) -> int:
        """Count of reads, since opening, whose bytes another program had taken."""
        channel = self._channel
        return channel.stolen if channel else 0

    @property
    def byte_time_ns(self) -> int:
        """Duration of a byte on the line in ns; 0 for native USB and networks."""
        name = os.path.basename(os.path.realpath(self._path)) if self._path else ''
        return byte_time_ns(self.baud_rate) if name and not name.startswith(_NO_LINE_RATE) else 0

    def connect(self) -> None:
        """Open the port for this process alone; LinkError if that is not possible."""
        self.close()
        try:
            channel = self._open()
        except Exception as error:
            raise why_not_open(self._target(), error) from error
        self._writer_waker.clear()
        self._channel = channel
        self._was_open = True

    def read(self) -> Reading | None:
        """Wait for bytes and return all; None on a timeout, LinkError if the port is gone."""
        try:
            return self._open_channel().read(READ_TIMEOUT, self._reader_waker)
        except Exception as error:
            raise why_gone(self._target(), error) from error

    def write(self, data: bytes, wait: bool = True) -> None:
        """
        Send all of data; LinkError if the port is gone or does not accept it in time.

        Without wait, the port must accept data at once.
        """
        try:
            self._write(data, WRITE_TIMEOUT if wait else 0.0)
        except Exception as error:
            raise why_not_written(self._target(), error) from error

    def cancel(self) -> None:
        """Interrupt writes that wait, and the current or next connect() or read()."""
        self._reader_waker.wake()
        self._writer_waker.wake()

    def close(self) -> None:
        """Close the port, if it is open."""
        self._writer_waker.wake()
        with self._writing:
            channel, self._channel = self._channel, None
        if channel:
            channel.close()

    def _open(self) -> Channel:
        address = self._address
        if address.is_network:
            return self._connect_to_server()
        if address.scheme == 'loop':
            return open_loop(address.text, self.baud_rate)
        if address.pattern:
            self._path = ''
            self._path = find_device(address.pattern, address.number)
        return SerialPort(self._path, self.baud_rate)

    def _connect_to_server(self) -> Channel:
        address = self._address
        connect: Callable[[], Channel]
        if address.scheme == 'socket':
            connect = partial(TcpConnection, address.host, address.port)
        else:
            connect = partial(open_rfc2217, address.text, self.baud_rate)
        channel = InterruptibleCall[Channel](connect).wait(self._reader_waker)
        if channel is None:
            raise InterruptedError('the driver is being stopped')
        return channel

    def _write(self, data: bytes, timeout: float) -> None:
        if not self._writing.acquire(blocking=timeout > 0):
            raise TimeoutError('another request waits to be written')
        try:
            self._open_channel().write(data, timeout, self._writer_waker)
        finally:
            self._writing.release()

    def _open_channel(self) -> Channel:
        if self._channel is None:
            raise OSError('it is not open')
        return self._channel

    def _target(self) -> Target:
        name = self.name
        if self._path and self._path != self.port:
            name = f'{name} ({printable(self._path)})'
        return Target(name, self._path, self.baud_rate, self._was_open)
