# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the driver needs of a sensor, in one place for each.

A new sensor is a protocol module, a converter, and a function here.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
import math
from typing import Any, Protocol

from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs import BahrsConverter, BahrsOptions, TOPICS as BAHRS_TOPICS
from bahrs_driver.protocol.bahrs_frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.receiver import Codec


class Converter(Protocol):
    """What turns device messages into ROS messages."""

    def reset(self) -> None:
        """Forget the stream so far; another one begins."""

    def convert(self, message: Any, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Return the topics and ROS messages that a device message becomes."""


@dataclass(frozen=True)
class Sensor:
    """The parts that drive one kind of device."""

    framer: Framer
    codec: Codec
    converter: Converter
    topics: Mapping[str, type]
    protocol: Callable[[], Mapping[str, str]]       # what was detected, for diagnostics


def bahrs(settings: Mapping[str, Any]) -> Sensor:
    """Return the parts for a BAHRS."""
    frame_format = BahrsFormat(settings['crc_order'])
    options = BahrsOptions(
        frame_id=settings['frame_id'],
        world_frame_id=settings['world_frame_id'],
        convention=CONVENTIONS[settings['frame_convention']],
        force_stddev=settings['stddev.specific_force'],
        rate_stddev=settings['stddev.angular_rate'],
        height_stddev=settings['stddev.pressure_height'],
        velocity_stddev=settings['stddev.velocity'],
        declination=math.radians(settings['magnetic_field.declination']),
        field_strength=settings['magnetic_field.strength'],
        field_dip=math.radians(settings['magnetic_field.dip']),
        publish_field=settings['publish.derived_magnetic_field'])

    def protocol() -> Mapping[str, str]:
        return {'Protocol version': str(frame_format.version_seen or 'not seen yet'),
                'CRC order': frame_format.order_seen or 'not seen yet'}

    return Sensor(Framer(frame_format), BahrsCodec(settings['pressure_height.format']),
                  BahrsConverter(options), BAHRS_TOPICS, protocol)


SENSORS: dict[str, Callable[[Mapping[str, Any]], Sensor]] = {'bahrs': bahrs}
