# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Create the parts for a stream of a Titan-M."""

from collections.abc import Iterator, Mapping
import math
from typing import Any

from bahrs_driver.clock import ArrivalClock, Clock, ExchangeClock
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.titan_m.converter import (
    TitanConverter, TitanDeviations, TitanOptions,
)
from bahrs_driver.devices.mounting import mounting
from bahrs_driver.devices.parts import LivePart, Parts
from bahrs_driver.devices.titan_m.health import TitanHealth
from bahrs_driver.devices.titan_m.requests_task import RequestsTask
from bahrs_driver.devices.titan_m.settings import TitanMSettings
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.decoder import TitanDecoder
from bahrs_driver.protocol.titan_m.frames import answer_size, AnswerFormat, REQUEST_SIZE
from bahrs_driver.protocol.titan_m.messages import (
    GpsRequest, SensorsRequest, StateRequest, TitanRequest)
from bahrs_driver.protocol.titan_m.poller import Poller, PollOptions
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.request_loop import RequestLoop
from bahrs_driver.units import byte_time_ns, NS_PER_S

SILENCE_HINT = 'is the device powered, are both of its lines connected, and is {} its baud rate?'
NO_REQUESTS_HINT = ('state.rate, gps.rate and sensors.rate are 0, so nothing is requested, and no '
                    'other program seems to send requests either')
PAUSES = 2.5            # periods of the most frequent answer before the device counts as silent

Rates = Mapping[type[TitanRequest], float]      # Hz


def make_parts(settings: TitanMSettings) -> Parts:
    """Create the parts for one stream; if all rates are 0, they send no requests."""
    frame_format = AnswerFormat(settings.checksum_order)
    rates = _rates(settings)
    poller = _poller(settings, rates, frame_format) if any(rates.values()) else None
    payloads = PayloadDecoder[Any](settings.payload_order)
    converter = TitanConverter(_options(settings, rates))
    silence_timeout = _silence_timeout(settings, rates)
    health = TitanHealth(
        _monitored_rates(rates), settings.diagnostics.rate_tolerance, silence_timeout, poller,
        payloads, lambda: converter.gps_status, lambda: converter.week_problem)
    return Parts(
        Framer(frame_format), TitanDecoder(payloads, poller), _clock(settings), converter, health,
        silence_timeout,
        SILENCE_HINT.format(settings.baud_rate) if poller else NO_REQUESTS_HINT,
        live=lambda link: _live_part(link, poller, health),
        protocol=lambda: _protocol(payloads, frame_format),
        take_notices=converter.take_notices, warnings=tuple(_warnings(settings, rates)))


def _live_part(link: Link, poller: Poller | None, health: TitanHealth) -> LivePart:
    if poller is None:
        return LivePart()
    return LivePart(requests=RequestLoop(link, poller), tasks=[RequestsTask(poller, health.stale)])


def _poller(settings: TitanMSettings, rates: Rates, frame_format: AnswerFormat) -> Poller:
    return Poller(rates, frame_format, PollOptions(
        pipelined=settings.request.pipelined,
        timeout=round(settings.request.timeout * NS_PER_S),
        retries=settings.request.retries,
        counted_ids=settings.request.message_id == 'counted',
        checksum_order=settings.checksum_order))


def _protocol(payloads: PayloadDecoder[Any], frame_format: AnswerFormat) -> Mapping[str, str]:
    """Return the detected properties of the protocol, by name."""
    lengths = sorted((kind.NAME, length) for kind, length in frame_format.lengths_seen.items())
    return {'Payload byte order': payloads.order or 'not known yet',
            'Checksum byte order': frame_format.checksum_order.seen or 'not seen yet',
            'LEN': ', '.join(f'{name} 0x{length:02X}' for name, length in lengths)
            or 'not seen yet'}


def _rates(settings: TitanMSettings) -> Rates:
    # Sensors before state: imu/data takes force and rate from them.
    return {SensorsRequest: settings.sensors.rate, StateRequest: settings.state.rate,
            GpsRequest: settings.gps.rate}


def _silence_timeout(settings: TitanMSettings, rates: Rates) -> float:
    """Return the seconds without an answer after which the device counts as silent."""
    highest = max(rates.values())
    return max(settings.diagnostics.silence_timeout, PAUSES / highest if highest else 0.0)


def _monitored_rates(rates: Rates) -> dict[str, float]:
    """Return the expected rates by answer; without requests, any answer may arrive."""
    return {kind.ANSWER.NAME: rate for kind, rate in rates.items()
            if rate or not any(rates.values())}


def _clock(settings: TitanMSettings) -> Clock:
    latency = round(settings.time.fixed_latency * NS_PER_S)
    if settings.time.source == 'arrival':
        return ArrivalClock(latency)
    return ExchangeClock(REQUEST_SIZE, latency)


def _warnings(settings: TitanMSettings, rates: Rates) -> Iterator[str]:
    if settings.time.source == 'sync_pulse':
        yield ("parameter time.source is 'sync_pulse': a titan_m has no sync pulses, stamps are "
               "the middle of request and answer, as with 'device'")
    if not any(rates.values()):
        yield ('parameters state.rate, gps.rate and sensors.rate are all 0: nothing is requested, '
               'and only answers to other programs are published')
    use = sum(rate * answer_size(kind.ANSWER) for kind, rate in rates.items()) \
        * byte_time_ns(settings.baud_rate) / NS_PER_S
    if use > 1:
        yield (f'parameters state.rate, gps.rate and sensors.rate ask for {use:.0%} of what the '
               f'line carries at {settings.baud_rate} baud: the rates will be lower')


def _options(settings: TitanMSettings, rates: Rates) -> TitanOptions:
    return TitanOptions(
        frame_id=settings.frame_id,
        world_frame_id=settings.world_frame_id,
        convention=CONVENTIONS[settings.frame_convention],
        deviations=TitanDeviations(
            force=settings.stddev.specific_force, rate=settings.stddev.angular_rate,
            attitude=settings.stddev.attitude, heading=settings.stddev.heading,
            velocity=settings.stddev.velocity, position=settings.stddev.position,
            altitude=settings.stddev.altitude, field=settings.stddev.magnetic_field,
            static_pressure=settings.stddev.static_pressure,
            differential_pressure=settings.stddev.differential_pressure,
            temperature=settings.stddev.temperature),
        declination=math.radians(settings.magnetic_field.declination),
        geoid_height=settings.gps.geoid_height,
        gps_week=settings.gps.week,
        leap_seconds=settings.gps.leap_seconds,
        requested={kind.ANSWER for kind, rate in rates.items() if rate} or None,
        withhold_incomplete=settings.publish.incomplete == 'withhold',
        mounting=mounting(settings) if settings.publish.tf else None)
