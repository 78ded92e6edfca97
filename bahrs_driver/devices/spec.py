# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The specification of a kind of device.

docs/adding-a-device.md adds a device step by step. A specification imports no ROS: `bahrs decode`,
`bahrs emulate` and bahrs_driver.read() work without it.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, ClassVar, Generic, TYPE_CHECKING, TypeVar

from bahrs_driver.devices.recording_format import RecordingFormat
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.stream_decoder import StreamDecoder
from bahrs_driver.protocol.framing import Frame, FrameFormat
from bahrs_driver.protocol.memory import MemoryFormat
from bahrs_driver.protocol.message_roles import MessageRoles

if TYPE_CHECKING:
    from bahrs_driver.devices.nvm_reader import NvmReader
    from bahrs_driver.devices.parts import Parts
    from bahrs_driver.emulator.device import EmulatedDeviceFactory
    from bahrs_driver.pipeline import Pipeline
    from bahrs_driver.transport.link import Link

Settings = TypeVar('Settings', bound=CommonSettings)


class DeviceSpec(ABC, Generic[Settings]):
    """One kind of device."""

    name: ClassVar[str]                     # value of the parameter `sensor`
    label: ClassVar[str]                    # name in sentences
    settings: type[Settings]
    examples: ClassVar[Mapping[str, str]] = {}      # lines for the help, by verb
    # Requests to write, one after another, to find a device that answers only.
    probe_requests: ClassVar[Sequence[bytes]] = ()
    # Message types for the clock; None if messages hold no device time of samples.
    roles: ClassVar[MessageRoles | None] = None
    memory: ClassVar[MemoryFormat | None] = None
    stream_decoder: type[StreamDecoder[Settings]]

    @abstractmethod
    def frame_format(self) -> FrameFormat:
        """Return the frame format with default settings."""

    @abstractmethod
    def emulation(self) -> 'EmulatedDeviceFactory':
        """Return the emulation of the device."""

    def memory_access(self, link: 'Link') -> 'tuple[Pipeline, NvmReader]':
        """Return the pipeline for a link and the reader of the memory, for `bahrs nvm`."""
        raise NotImplementedError(f'a {self.label} has no memory')

    def recording_format(self, _settings: Settings) -> RecordingFormat | None:
        """Return how to read recorded frames in blocks; None if they have no device time."""
        return None

    @abstractmethod
    def topics(self) -> Mapping[str, type]:
        """Return the class of the values of each topic, of `convert.values`."""

    def describe(self, _frame_format: Any) -> str:
        """Return the label, with properties that the format has detected in frames."""
        return self.label

    def frame_period(self, _frame: Frame) -> float | None:
        """Return the seconds between regular frames of this type; None for other frames."""
        return None

    def latched(self) -> Collection[str]:
        """Return the topics whose last message a late subscriber receives."""
        return ()

    def formats(self) -> Mapping[str, Callable[[Any], str]]:
        """Return how to show messages of topics that no other device has, by topic."""
        return {}

    @abstractmethod
    def parts(self, settings: Settings) -> 'Parts':
        """Return new parts for one stream."""


AnyDevice = DeviceSpec[Any]
