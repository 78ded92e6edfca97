# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The specification of the BAHRS."""

from collections.abc import Collection, Mapping
from typing import Any, TYPE_CHECKING

from bahrs_driver.devices.bahrs.recording_format import make_recording_format
from bahrs_driver.devices.bahrs.settings import BahrsSettings
from bahrs_driver.devices.bahrs.stream_decoder import BahrsStreamDecoder
from bahrs_driver.devices.recording_format import RecordingFormat
from bahrs_driver.devices.spec import DeviceSpec
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat, frame_type
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation
from bahrs_driver.protocol.bahrs.nvm_image import MEMORY
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Frame, FrameFormat, Framer

if TYPE_CHECKING:
    from bahrs_driver.devices.nvm_reader import NvmReader
    from bahrs_driver.devices.parts import Parts
    from bahrs_driver.emulator.device import EmulatedDeviceFactory
    from bahrs_driver.pipeline import Pipeline
    from bahrs_driver.transport.link import Link

PERIODS = {Inertial.TYPE: 0.005, Navigation.TYPE: 0.01}     # s


class BahrsSpec(DeviceSpec[BahrsSettings]):
    """A BAHRS."""

    name = 'bahrs'
    label = 'BAHRS'
    settings = BahrsSettings
    roles = ROLES
    memory = MEMORY
    stream_decoder = BahrsStreamDecoder

    def frame_format(self) -> FrameFormat:
        """Return the frame format with default settings."""
        return BahrsFormat()

    def describe(self, frame_format: Any) -> str:
        """Return the label with the protocol version that the format has seen."""
        return f'{self.label} of protocol version {frame_format.version_seen}'

    def frame_period(self, frame: Frame) -> float | None:
        """Return the seconds between regular frames of this type; None for other frames."""
        return PERIODS.get(frame_type(frame.data))

    def emulation(self) -> 'EmulatedDeviceFactory':
        """Return what emulates the device."""
        from bahrs_driver.devices.bahrs import emulation
        return emulation

    def memory_access(self, link: 'Link') -> 'tuple[Pipeline, NvmReader]':
        """Return what decodes a link and reads the memory through it, for `bahrs nvm`."""
        from bahrs_driver.devices.nvm_reader import NvmReader
        from bahrs_driver.pipeline import Pipeline
        from bahrs_driver.transport.request_loop import RequestLoop
        frame_format = BahrsFormat()
        return (Pipeline(Framer(frame_format), BahrsCodec()),
                NvmReader(RequestLoop(link), lambda: frame_format.version_seen))

    def recording_format(self, settings: BahrsSettings) -> RecordingFormat:
        """Return how `bahrs report` reads recorded frames."""
        return make_recording_format(settings, self.label)

    def topics(self) -> Mapping[str, type]:
        """Return the class of the values of each topic."""
        from bahrs_driver.convert.bahrs.converter import TOPICS
        return TOPICS

    def latched(self) -> Collection[str]:
        """Return the topics whose last message a late subscriber receives."""
        from bahrs_driver.convert.bahrs.converter import LATCHED
        return LATCHED

    def parts(self, settings: BahrsSettings) -> 'Parts':
        """Return new parts for one stream."""
        from bahrs_driver.devices.bahrs.parts import make_parts
        return make_parts(settings)
