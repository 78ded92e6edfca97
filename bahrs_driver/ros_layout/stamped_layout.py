# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The layout of a serialized ROS message of a header and numbers, as nearly all messages are."""

from collections.abc import Callable
from functools import lru_cache
from itertools import chain
from typing import Any

from bahrs_driver.ros_layout.message_layout import (
    ENCAPSULATION, MessageLayout, parts_of, text_bytes,
)
from bahrs_driver.ros_layout.rows import HEADER, Kind, Row
from bahrs_driver.units import NS_PER_S

_joined = chain.from_iterable


class StampedLayout(MessageLayout):
    """The layout of one message type with a header; the other rows are numbers."""

    def __init__(self, name: str, *rows: Row) -> None:
        """Take the name of the type, and its rows behind those of the header."""
        super().__init__(name, *HEADER, *rows)
        # Of the values behind the header: whether they are tuples, and which ones.
        self._numbers = [(kind is Kind.NUMBERS, part)
                         for kind, part in parts_of(self.rows)[len(HEADER):]]
        self._frame = lru_cache(maxsize=64)(self._make_frame)

    def serialize(self, values: tuple[Any, ...]) -> bytes:
        """Return the serialized message; struct.error if a number does not fit its field."""
        pack, size, frame = self._frame(values[1])
        seconds, nanoseconds = divmod(values[0], NS_PER_S)
        numbers: list[Any] = []
        for nested, part in self._numbers:
            numbers += _joined(values[part]) if nested else values[part]
        return pack(ENCAPSULATION, seconds, nanoseconds, size, frame, *numbers)

    def _make_frame(self, frame_id: str) -> tuple[Callable[..., bytes], int, bytes]:
        """Return how to pack messages of a frame, and the size and bytes of its name."""
        frame = text_bytes(frame_id)
        return self.packer((len(frame),)), len(frame), frame
