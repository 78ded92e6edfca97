# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Create the parts for a stream of a BAHRS."""

from collections.abc import Mapping
import math

from bahrs_driver.clock import ArrivalClock, Clock, ClockOptions, SampleClock
from bahrs_driver.convert import nvm_page
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs.converter import BahrsConverter, BahrsOptions
from bahrs_driver.convert.bahrs.integrity_policy import IntegrityPolicy
from bahrs_driver.convert.outgoing import Outgoing
from bahrs_driver.convert.values import UInt8MultiArray
from bahrs_driver.devices.bahrs.health import BahrsHealth
from bahrs_driver.devices.bahrs.settings import BahrsSettings, ROS_CLOCK
from bahrs_driver.devices.mounting import mounting
from bahrs_driver.devices.nvm_reader import NvmReader
from bahrs_driver.devices.parts import LivePart, Parts
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import NvmPage
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.message import Message
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.request_loop import RequestLoop
from bahrs_driver.units import NS_PER_S

SILENCE_HINT = ('is the device powered, and is its line connected? A Titan-M sends nothing unless '
                'asked: for one, set parameter sensor to titan_m')


def make_parts(settings: BahrsSettings) -> Parts:
    """Create the parts for one stream."""
    frame_format = BahrsFormat(settings.crc_order)
    converter = BahrsConverter(_options(settings))
    reference = settings.time.sync_pulse.reference
    silence_timeout = settings.diagnostics.silence_timeout
    health = BahrsHealth(converter.signals, settings.diagnostics.rate_tolerance,
                         silence_timeout)

    def protocol() -> Mapping[str, str]:
        return {'Protocol version': str(frame_format.version_seen or 'not seen yet'),
                'CRC order': frame_format.order_seen or 'not seen yet'}

    def live(link: Link) -> LivePart:
        requests = RequestLoop(link)
        nvm = NvmReader(requests, lambda: frame_format.version_seen)
        health.watch_nvm(lambda: nvm.status)
        return LivePart(nvm, requests)

    return Parts(
        Framer(frame_format), BahrsCodec(settings.pressure_height.format), _clock(settings),
        converter, health, silence_timeout, SILENCE_HINT, protocol=protocol, live=live,
        time_label=settings.time.label, pulse_topic='' if reference == ROS_CLOCK else reference,
        service_topics={nvm_page.TOPIC: UInt8MultiArray}, service_messages=_service_messages)


def _service_messages(message: Message) -> Outgoing:
    if isinstance(message, NvmPage):
        yield nvm_page.TOPIC, nvm_page.message(message.page, message.data)


def _clock(settings: BahrsSettings) -> Clock:
    source, latency = settings.time.source, round(settings.time.fixed_latency * NS_PER_S)
    if source == 'arrival':
        return ArrivalClock(latency)
    return SampleClock(ROLES, ClockOptions(
        source, settings.time.label, latency,
        round(settings.time.sync_pulse.period * NS_PER_S),
        settings.time.sync_pulse.reference != ROS_CLOCK))


def _options(settings: BahrsSettings) -> BahrsOptions:
    return BahrsOptions(
        frame_id=settings.frame_id,
        world_frame_id=settings.world_frame_id,
        convention=CONVENTIONS[settings.frame_convention],
        force_stddev=settings.stddev.specific_force,
        rate_stddev=settings.stddev.angular_rate,
        height_stddev=settings.stddev.pressure_height,
        velocity_stddev=settings.stddev.velocity,
        declination=math.radians(settings.magnetic_field.declination),
        field_strength=settings.magnetic_field.strength,
        field_dip=math.radians(settings.magnetic_field.dip),
        publish_field=settings.publish.derived_magnetic_field,
        integrity_policy=IntegrityPolicy(settings.integrity.risk_policy,
                                         settings.integrity.risk_inflation),
        orientation_fallback=settings.stddev.orientation_fallback,
        withhold_incomplete=settings.publish.incomplete == 'withhold',
        whole_vectors=settings.publish.incomplete == 'not_reported',
        mounting=mounting(settings) if settings.publish.tf else None)
