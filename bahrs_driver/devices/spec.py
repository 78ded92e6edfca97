# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the driver needs of a sensor, whichever it is."""

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from bahrs_driver.clock import Clock
from bahrs_driver.diagnostics.task import Task
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.transport.nvm_reader import NvmReader
from bahrs_driver.transport.receiver import Codec
from bahrs_driver.transport.requester import Requester


class Converter(Protocol):
    """What turns device messages into ROS messages."""

    def lost(self, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Forget the stream, and return what is to be said about its end."""

    def silent(self, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Return what is to be said about a stream that pauses."""

    def convert(self, message: Any, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Return the topics and ROS messages that a device message becomes."""


class Health(Protocol):
    """What watches the messages of a device."""

    tasks: Sequence[Task]

    def observe(self, message: Any, now: float) -> None:
        """Take a message, received at a time in seconds (monotonic)."""

    def opened(self) -> None:
        """Take note that another stream begins."""

    def stale(self, now: float) -> bool:
        """Return whether the data has ceased, at a time in seconds (monotonic)."""

    @property
    def lost(self) -> int:
        """Messages lost since the start."""

    def device_id(self) -> str:
        """Return the name that the device gives itself; empty if it did not."""


@dataclass(frozen=True)
class Sensor:
    """The parts that drive one kind of device."""

    framer: Framer
    codec: Codec
    clock: Clock
    converter: Converter
    health: Health
    topics: Mapping[str, type]
    latched: Container[str]                         # topics that a late joiner gets the last of
    protocol: Callable[[], Mapping[str, str]]       # what was detected, for diagnostics
    silence_timeout: float                          # s without data that are reported
    silence_hint: str                               # what to look at then
    nvm: NvmReader | None = None                    # for devices whose memory can be read
    requester: Requester | None = None              # for devices that speak when asked
    warnings: Sequence[str] = ()                    # what the user should know of the settings
    take_notices: Callable[[], list[str]] = list    # and of the data, since the last call
