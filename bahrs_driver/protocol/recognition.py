# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Which of the devices bytes are from, told by whole frames."""

from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.titan_m.frames import AnswerFormat


def sensor_of(data: bytes) -> str:
    """Return the name of the sensor, as the parameter has it, whose frames are in data, or ''."""
    for name, framer in (('bahrs', Framer(BahrsFormat())), ('titan_m', Framer(AnswerFormat()))):
        framer.feed(data)
        framer.flush()
        if framer.counters.frames:
            return name
    return ''
