# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode the recorded bytes of a device, for `bahrs decode`."""

from abc import ABC, abstractmethod
import argparse
from collections.abc import Iterable, Sequence
from typing import Any

from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.message import Message


class StreamDecoder(ABC):
    """Decodes a stream of bytes; a device overrides what differs."""

    head: Sequence[str] = ()        # names of the values of head_values()

    framer: Framer
    kinds: Sequence[type[Message]]  # of the messages

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Add the options of `bahrs decode` that only this device has."""

    @abstractmethod
    def __init__(self, options: argparse.Namespace) -> None:
        """Set framer and kinds."""

    @abstractmethod
    def decode(self, frame: Frame, _now: int = 0) -> Any:
        """Return the message of an intact frame."""

    def expected(self) -> Sequence[Any]:
        """Return the messages that were requested: none."""
        return ()

    def messages(self, frames: Iterable[Frame]) -> Iterable[tuple[Frame, Any]]:
        """Return the messages that the frames complete, in the order of the stream."""
        return ((frame, self.decode(frame)) for frame in frames)

    def head_values(self, _frame: Frame) -> dict[str, Any]:
        """Return properties of a frame that its message lacks."""
        return {}

    def unavailable(self, _message: Any) -> Sequence[str]:
        """Return the columns whose number in the message is not a measurement."""
        return ()

    def detected(self) -> list[tuple[str, object]]:
        """Return detected properties of the protocol, by name."""
        return []

    def complaint(self) -> str:
        """Return why messages could not be decoded; empty if all could."""
        return ''
