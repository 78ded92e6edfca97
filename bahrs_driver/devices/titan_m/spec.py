# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The specification of the Titan-M."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from bahrs_driver.devices.spec import DeviceSpec
from bahrs_driver.devices.titan_m.settings import TitanMSettings
from bahrs_driver.devices.titan_m.stream_decoder import TitanStreamDecoder
from bahrs_driver.protocol.framing import FrameFormat
from bahrs_driver.protocol.titan_m.frames import AnswerFormat, build_request, CHECKSUM_ORDERS
from bahrs_driver.protocol.titan_m.messages import StateRequest

if TYPE_CHECKING:
    from bahrs_driver.devices.parts import Parts
    from bahrs_driver.emulator.device import EmulatedDeviceFactory


class TitanSpec(DeviceSpec[TitanMSettings]):
    """A Titan-M."""

    name = 'titan_m'
    label = 'Titan-M'
    settings = TitanMSettings
    examples = {
        'decode': '  bahrs decode --sensor titan_m answers.bin     what a Titan-M answered\n',
        'emulate': '  bahrs emulate --sensor titan_m --start 0,6          answers requests, '
                   'about the equator\n'}
    # The byte order of checksums that the device accepts is not known.
    probe_requests = tuple(build_request(StateRequest, checksum_order=order)
                           for order in CHECKSUM_ORDERS)
    stream_decoder = TitanStreamDecoder

    def frame_format(self) -> FrameFormat:
        """Return the frame format with default settings."""
        return AnswerFormat()

    def emulation(self) -> 'EmulatedDeviceFactory':
        """Return what emulates the device."""
        from bahrs_driver.devices.titan_m import emulation
        return emulation

    def topics(self) -> Mapping[str, type]:
        """Return the class of the values of each topic."""
        from bahrs_driver.convert.titan_m.converter import TOPICS
        return TOPICS

    def parts(self, settings: TitanMSettings) -> 'Parts':
        """Return new parts for one stream; without a rate they make no requests."""
        from bahrs_driver.devices.titan_m.parts import make_parts
        return make_parts(settings)
