# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Decode the bytes of a device into typed messages, without a port and without ROS."""

from abc import ABC, abstractmethod
import argparse
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

from bahrs_driver.clock import Clock
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.block_format import BlockFormat
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message

Settings = TypeVar('Settings', bound=CommonSettings)


class StreamDecoder(ABC, Generic[Settings]):
    """Decodes a stream of bytes; a device overrides what differs."""

    head: Sequence[str] = ()        # names of the values of head_values()

    pipeline: Pipeline
    kinds: Sequence[type[Message]]  # of the messages

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Add the options of `bahrs decode` that only this device has."""

    @classmethod
    def settings(cls, _options: argparse.Namespace) -> Settings | None:
        """Return the settings that the options of `bahrs decode` stand for; None for defaults."""
        return None

    @abstractmethod
    def __init__(self, settings: Settings, clock: Clock | None = None) -> None:
        """Set pipeline, which leaves messages unstamped without a clock."""

    def head_values(self, _frame: Frame) -> dict[str, object]:
        """Return properties of a frame that its message lacks."""
        return {}

    def unavailable(self, _message: Message) -> Sequence[str]:
        """Return the columns whose number in the message is not a measurement."""
        return ()

    def detected(self) -> list[tuple[str, object]]:
        """Return detected properties of the protocol, by name."""
        return []

    def block_format(self) -> tuple[BlockFormat, dict[bytes, str]] | None:
        """Return the format of frames that can be found in blocks, and message names by header."""
        return None

    def complaint(self) -> str:
        """Return why messages could not be decoded; empty if all could."""
        return ''


AnyDecoder = StreamDecoder[Any]
