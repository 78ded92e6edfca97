# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The events of a port, in the order in which a PortReader yields them."""

from collections.abc import Sequence
from typing import NamedTuple

from bahrs_driver.pipeline import Event
from bahrs_driver.transport.channel import Reading


class Connection(NamedTuple):
    """One opening of the port, from 1; byte_time_ns is 0 for a line without a baud rate."""

    number: int
    byte_time_ns: int


class PortOpened(NamedTuple):
    """A connection was opened, and a stream begins. The port may be lost again at once."""

    connection: Connection


class PortUsable(NamedTuple):
    """The port is open and delivers frames, or stays open. Yielded once for a connection."""

    connection: Connection


class PortUnavailable(NamedTuple):
    """
    The port cannot be opened, or was lost, which ends the stream.

    `reported` is True if the event before gave the same reason, and only a stream has ended.
    """

    reason: str
    reported: bool


class BytesRead(NamedTuple):
    """A read returned bytes; events is None if there are none and no frame was complete."""

    reading: Reading
    connection: Connection
    events: Sequence[Event] | None


class StreamEnded(NamedTuple):
    """The pipeline returned events at the end of a stream."""

    events: Sequence[Event]


class Silence(NamedTuple):
    """A read timed out without a byte."""


PortEvent = PortOpened | PortUsable | PortUnavailable | BytesRead | StreamEnded | Silence
