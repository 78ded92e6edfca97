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

from bahrs_driver.clock import (
    ArrivalStamps, byte_time_ns, Clock, ClockOptions, ExchangeClock, NANOSECONDS, SampleClock,
)
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs import (
    BahrsConverter, BahrsOptions, LATCHED as BAHRS_LATCHED, TOPICS as BAHRS_TOPICS,
)
from bahrs_driver.convert.titan_m import (
    LATCHED as TITAN_LATCHED, TitanConverter, TitanDeviations, TitanOptions,
    TOPICS as TITAN_TOPICS,
)
from bahrs_driver.convert.worth import Appraisal
from bahrs_driver.diagnostics.bahrs_health import BahrsHealth
from bahrs_driver.diagnostics.task import Task
from bahrs_driver.diagnostics.titan_health import TitanHealth
from bahrs_driver.link import Link
from bahrs_driver.nvm_reader import NvmReader
from bahrs_driver.protocol.bahrs_frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.payload_order import PayloadReader
from bahrs_driver.protocol.poller import Poller, PollOptions
from bahrs_driver.protocol.titan_frames import (
    answer_size, AnswerCodec, AnswerFormat, REQUEST_SIZE,
)
from bahrs_driver.protocol.titan_m import GpsRequest, SensorsRequest, StateRequest, TitanRequest
from bahrs_driver.receiver import Codec
from bahrs_driver.requester import Requester

ROS_CLOCK = 'ros_clock'
PAUSES = 2.5            # of the slowest message that must come, before the device is silent


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
    nvm: NvmReader | None = None                    # for devices whose memory can be read
    requester: Requester | None = None              # for devices that speak when asked
    longest_pause: float = 0.0                      # s, which is no silence
    warnings: Sequence[str] = ()                    # what the user should know of the settings


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


def titan_m(settings: Mapping[str, Any], link: Link) -> Sensor:
    """Return the parts for a Titan-M on a link. If nothing is to be asked, it only listens."""
    frame_format = AnswerFormat(settings['checksum_order'])
    rates = _titan_rates(settings)
    poller = Poller(rates, frame_format, PollOptions(
        pipelined=settings['request.pipelined'],
        timeout=round(settings['request.timeout'] * NANOSECONDS),
        retries=settings['request.retries'],
        counted_ids=settings['request.message_id'] == 'counted',
        checksum_order=settings['checksum_order']))
    requester = Requester(link, poller) if any(rates.values()) else None
    if requester:
        frame_format.expected = requester.expected
    reader = PayloadReader[int](settings['payload_order'])
    converter = TitanConverter(_titan_options(settings), reader)
    asked = {kind.ANSWER.NAME: rate for kind, rate in rates.items() if rate or not requester}
    longest_pause = PAUSES / max(rates.values()) if requester else 0.0
    health = TitanHealth(
        asked, settings['diagnostics.rate_tolerance'],
        max(settings['diagnostics.silence_timeout'], longest_pause),
        poller if requester else None, reader,
        lambda: converter.gps_text)

    def protocol() -> Mapping[str, str]:
        lengths = {kind.NAME: f'0x{length:02X}'
                   for kind, length in sorted(frame_format.lengths_seen.items(),
                                              key=lambda item: item[0].NAME)}
        return {'Payload byte order': reader.order or 'not known yet',
                'Checksum byte order': frame_format.checksum_order.seen or 'not seen yet',
                'LEN': ', '.join(f'{name} {text}' for name, text in lengths.items())
                or 'not seen yet'}

    return Sensor(Framer(frame_format), requester or AnswerCodec(), _titan_clock(settings),
                  converter, health, TITAN_TOPICS, TITAN_LATCHED, protocol, requester=requester,
                  longest_pause=longest_pause,
                  warnings=tuple(_titan_warnings(settings, rates)))


def _titan_rates(settings: Mapping[str, Any]) -> dict[type[TitanRequest], float]:
    # Sensors before state: they are what imu/data has of force and rate.
    return {SensorsRequest: settings['sensors.rate'], StateRequest: settings['state.rate'],
            GpsRequest: settings['gps.rate']}


def _titan_clock(settings: Mapping[str, Any]) -> Clock:
    latency = round(settings['time.fixed_latency'] * NANOSECONDS)
    if settings['time.source'] == 'arrival':
        return ArrivalStamps(latency)
    return ExchangeClock(REQUEST_SIZE, latency)


def _titan_warnings(settings: Mapping[str, Any],
                    rates: Mapping[type[TitanRequest], float]) -> Iterator[str]:
    if settings['time.source'] == 'sync_pulse':
        yield ("parameter time.source is 'sync_pulse': a titan_m has no sync pulses, stamps are "
               "the middle of request and answer, as with 'device'")
    if not any(rates.values()):
        yield ('parameters state.rate, gps.rate and sensors.rate are all 0: the device is asked '
               'nothing, and what it says to somebody else is taken')
    use = sum(rate * answer_size(kind.ANSWER) for kind, rate in rates.items()) \
        * byte_time_ns(settings['baud_rate']) / NANOSECONDS
    if use > 1:
        yield (f'parameters state.rate, gps.rate and sensors.rate ask for {use:.0%} of what the '
               f"line carries at {settings['baud_rate']} baud: the rates will be lower")


def _titan_options(settings: Mapping[str, Any]) -> TitanOptions:
    return TitanOptions(
        frame_id=settings['frame_id'],
        world_frame_id=settings['world_frame_id'],
        convention=CONVENTIONS[settings['frame_convention']],
        deviations=TitanDeviations(
            force=settings['stddev.specific_force'], rate=settings['stddev.angular_rate'],
            attitude=settings['stddev.attitude'], heading=settings['stddev.heading'],
            velocity=settings['stddev.velocity'], position=settings['stddev.position'],
            altitude=settings['stddev.altitude'], field=settings['stddev.magnetic_field'],
            static_pressure=settings['stddev.static_pressure'],
            differential_pressure=settings['stddev.differential_pressure'],
            temperature=settings['stddev.temperature']),
        declination=math.radians(settings['magnetic_field.declination']),
        geoid_height=settings['gps.geoid_height'],
        gps_week=settings['gps.week'],
        leap_seconds=settings['gps.leap_seconds'],
        state_is_asked=bool(settings['state.rate']) or not settings['gps.rate'],
        gps_is_asked=bool(settings['gps.rate']) or not settings['state.rate'])


# Settings with which a sensor asks nothing, and takes what comes: for recordings.
LISTENING: dict[str, Mapping[str, Any]] = {
    'titan_m': dict.fromkeys(('state.rate', 'gps.rate', 'sensors.rate'), 0.0)}
SENSORS: dict[str, Callable[[Mapping[str, Any], Link], Sensor]] = {
    'bahrs': bahrs, 'titan_m': titan_m}
