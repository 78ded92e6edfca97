# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the driver needs of a sensor, in one place for each.

A new sensor is a protocol module, a converter, and a function here.
"""

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any, Protocol

from bahrs_driver.clock import ArrivalStamps, Clock, ClockOptions, NANOSECONDS, SampleClock
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs import (
    BahrsConverter, BahrsOptions, LATCHED as BAHRS_LATCHED, TOPICS as BAHRS_TOPICS,
)
from bahrs_driver.convert.worth import Appraisal
from bahrs_driver.diagnostics.bahrs_health import BahrsHealth
from bahrs_driver.diagnostics.task import Task
from bahrs_driver.link import Link
from bahrs_driver.nvm_reader import NvmReader
from bahrs_driver.protocol.bahrs_frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.receiver import Codec


ROS_CLOCK = 'ros_clock'


class Converter(Protocol):
    """What turns device messages into ROS messages."""

    def lost(self, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Forget the stream, and return what is to be said about its end."""

    def convert(self, message: Any, stamp_ns: int) -> Iterator[tuple[str, Any]]:
        """Return the topics and ROS messages that a device message becomes."""


class Health(Protocol):
    """What watches the messages of a device."""

    tasks: Sequence[Task]

    def observe(self, message: Any, now: float) -> None:
        """Take a message, received at a time in seconds (monotonic)."""

    def opened(self) -> None:
        """Take note that another stream begins."""

    def hardware_id(self) -> str:
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
    nvm: NvmReader | None                           # for devices whose memory can be read


def bahrs(settings: Mapping[str, Any], link: Link) -> Sensor:
    """Return the parts for a BAHRS on a link."""
    frame_format = BahrsFormat(settings['crc_order'])
    converter = BahrsConverter(_bahrs_options(settings))
    nvm = NvmReader(link, lambda: frame_format.version_seen, settings['nvm.enter_timeout'],
                    settings['nvm.service_frames'])
    health = BahrsHealth(converter.signals, settings['diagnostics.rate_tolerance'],
                         settings['diagnostics.silence_timeout'], lambda: nvm.status)

    def protocol() -> Mapping[str, str]:
        return {'Protocol version': str(frame_format.version_seen or 'not seen yet'),
                'CRC order': frame_format.order_seen or 'not seen yet'}

    return Sensor(Framer(frame_format), BahrsCodec(settings['pressure_height.format']),
                  _bahrs_clock(settings), converter, health, BAHRS_TOPICS, BAHRS_LATCHED, protocol,
                  nvm)


def _bahrs_clock(settings: Mapping[str, Any]) -> Clock:
    source, latency = settings['time.source'], round(settings['time.fixed_latency'] * NANOSECONDS)
    if source == 'arrival':
        return ArrivalStamps(latency)
    return SampleClock(ClockOptions(
        source, settings['time.label'], latency,
        round(settings['time.sync_pulse.period'] * NANOSECONDS),
        settings['time.sync_pulse.reference'] != ROS_CLOCK))


def _bahrs_options(settings: Mapping[str, Any]) -> BahrsOptions:
    return BahrsOptions(
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
        publish_field=settings['publish.derived_magnetic_field'],
        appraisal=Appraisal(settings['integrity.risk_policy'],
                            settings['integrity.risk_inflation']))


SENSORS: dict[str, Callable[[Mapping[str, Any], Link], Sensor]] = {'bahrs': bahrs}
