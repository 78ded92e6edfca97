# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
A TCP connection to a serial server in raw mode.

A server that loses power sends nothing more, and without keep-alive the connection would stay
established for ever. With keep-alive, the kernel sends a probe after KEEP_ALIVE_IDLE seconds
without a byte and closes the connection after DEAD_AFTER seconds without an answer. Sent data must
be acknowledged within the same time.
"""

import errno
import socket
import time

from bahrs_driver.transport.channel import DescriptorChannel

CONNECT_TIMEOUT = 5.0       # s, for all addresses of the host together
KEEP_ALIVE_IDLE = 2         # s
KEEP_ALIVE_INTERVAL = 1     # s
KEEP_ALIVE_PROBES = 3
DEAD_AFTER = KEEP_ALIVE_IDLE + KEEP_ALIVE_PROBES * KEEP_ALIVE_INTERVAL
OPTIONS = (
    (socket.IPPROTO_TCP, socket.TCP_NODELAY, 1),
    (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
    (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, KEEP_ALIVE_IDLE),
    (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, KEEP_ALIVE_INTERVAL),
    (socket.IPPROTO_TCP, socket.TCP_KEEPCNT, KEEP_ALIVE_PROBES),
    (socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, DEAD_AFTER * 1000))


class ConnectionClosed(ConnectionError):
    """The other end closed the connection."""


class TcpConnection(DescriptorChannel):
    """A connection that detects the loss of its other end."""

    def __init__(self, host: str, port: int) -> None:
        """Connect; OSError if no address of the host answers in time."""
        self._socket = _connect(host, port)
        detect_loss(self._socket)
        super().__init__(self._socket.fileno())

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def _handle_end_of_stream(self) -> None:
        raise ConnectionClosed(errno.ECONNRESET, 'the other end closed the connection')


def detect_loss(connection: socket.socket) -> None:
    """Make the kernel close a connection whose other end does not answer for DEAD_AFTER s."""
    for level, option, value in OPTIONS:
        connection.setsockopt(level, option, value)


def _connect(host: str, port: int) -> socket.socket:
    deadline = time.monotonic() + CONNECT_TIMEOUT
    failure = OSError(errno.EADDRNOTAVAIL, 'it has no address')
    for family, kind, protocol, _, address in socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM):
        connection = socket.socket(family, kind, protocol)
        try:
            connection.settimeout(max(0.1, deadline - time.monotonic()))
            connection.connect(address)
            return connection
        except OSError as error:
            connection.close()
            failure = error
    raise failure
