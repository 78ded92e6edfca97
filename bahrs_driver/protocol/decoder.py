# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface between the pipeline and the decoder of a device."""

from collections.abc import Collection
from typing import Protocol, TypeVar

from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message

ItemT = TypeVar('ItemT', bound='Item')


class Item(Protocol):
    """A message with its stamp, as a named tuple of the clock."""

    @property
    def message(self) -> Message:
        """Message of the device."""

    def _replace(self: ItemT, *, message: Message) -> ItemT:
        """Return a copy with another message."""


class Decoder:
    """
    Decodes the frames of one stream after the other. Most devices override decode() alone.

    A decoder neither reads a clock nor does I/O. Times are in ns of one steady clock.
    """

    def open(self, byte_time_ns: int) -> None:      # noqa: A003, the usual name
        """Begin a stream on a line that carries a byte in byte_time_ns; 0 if it has no rate."""

    def close(self) -> None:
        """End the stream."""

    def expected(self) -> Collection[type] | None:
        """Return the kinds of outstanding answers; None if the requests are not known."""
        return None

    def decode(self, frame: Frame, now: int, /) -> Message:
        """Return the message of an intact frame that was received by now."""
        raise NotImplementedError

    def resolve(self, items: list[ItemT]) -> list[ItemT]:
        """
        Complete messages whose payload could not be decoded before their stamp was known.

        Return all messages that can be delivered now, in stream order.
        """
        return items
