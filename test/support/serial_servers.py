# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Serial servers for one client, by the scheme of the URL that they are for."""

from collections.abc import Callable
import contextlib
import socket
import threading
from typing import Any

import serial
from serial import rfc2217


class Rfc2217Server:
    """A serial server with one port, whose device sends back what it gets."""

    def __init__(self, connection: socket.socket) -> None:
        """Serve one client, in a thread."""
        self._connection = connection
        # The stubs ask for more than PortManager uses.
        device: Any = serial.serial_for_url('loop://', baudrate=1_000_000, timeout=0.05)
        served: Any = self
        self._device = device
        self._manager = rfc2217.PortManager(device, served)
        threading.Thread(target=self._serve, daemon=True).start()

    def write(self, data: bytes) -> None:
        """Send to the client; what PortManager wants of a connection."""
        with contextlib.suppress(OSError):
            self._connection.sendall(data)

    def send(self, data: bytes) -> None:
        """Send as if the device did."""
        self.write(b''.join(self._manager.escape(data)))

    def _serve(self) -> None:
        with contextlib.suppress(OSError):
            while data := self._connection.recv(1024):
                self._device.write(b''.join(self._manager.filter(data)))
                self.send(self._device.read(self._device.in_waiting))

    def close(self) -> None:
        """Hang up."""
        with contextlib.suppress(OSError):
            self._connection.shutdown(socket.SHUT_RDWR)
        self._connection.close()


class RawServer:
    """A serial server in raw mode."""

    def __init__(self, connection: socket.socket) -> None:
        """Serve one client."""
        self._connection = connection
        self.send = connection.sendall
        self.close = connection.close


Server = RawServer | Rfc2217Server
SERVERS: dict[str, Callable[[socket.socket], Server]] = {
    'socket': RawServer, 'rfc2217': Rfc2217Server}
