# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The specification of the BAHRS."""

from collections.abc import Collection, Mapping
from typing import Any, TYPE_CHECKING

from bahrs_driver.devices.spec import DeviceSpec
from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.framing import FrameFormat

if TYPE_CHECKING:
    from bahrs_driver.devices.parts import Parts


class BahrsSpec(DeviceSpec):
    """A BAHRS."""

    name = 'bahrs'
    label = 'BAHRS'

    def frame_format(self) -> FrameFormat:
        """Return the frame format with default settings."""
        return BahrsFormat()

    def topics(self) -> Mapping[str, type]:
        """Return the message type of each topic."""
        from bahrs_driver.convert.bahrs.converter import TOPICS
        return TOPICS

    def latched(self) -> Collection[str]:
        """Return the topics whose last message a late subscriber receives."""
        from bahrs_driver.convert.bahrs.converter import LATCHED
        return LATCHED

    def parts(self, settings: Mapping[str, Any]) -> 'Parts':
        """Return new parts for one stream."""
        from bahrs_driver.devices.bahrs.parts import make_parts
        return make_parts(settings)
