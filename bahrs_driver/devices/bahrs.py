# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The parts that drive a BAHRS."""

from collections.abc import Mapping
import math
from typing import Any

from bahrs_driver.clock import ArrivalStamps, Clock, ClockOptions, SampleClock
from bahrs_driver.convert.axes import CONVENTIONS
from bahrs_driver.convert.bahrs.converter import BahrsConverter, BahrsOptions, LATCHED, TOPICS
from bahrs_driver.convert.bahrs.integrity_policy import Appraisal
from bahrs_driver.devices.bahrs_health import BahrsHealth
from bahrs_driver.devices.spec import Sensor
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.nvm_reader import NvmReader
from bahrs_driver.units import NS_PER_S

ROS_CLOCK = 'ros_clock'
SILENCE_HINT = ('is the device powered, and is its line connected? A Titan-M sends nothing unless '
                'asked: for one, set parameter sensor to titan_m')


def bahrs(settings: Mapping[str, Any], link: Link) -> Sensor:
    """Return the parts for a BAHRS on a link."""
    frame_format = BahrsFormat(settings['crc_order'])
    converter = BahrsConverter(_options(settings))
    nvm = NvmReader(link, lambda: frame_format.version_seen)
    silence_timeout = settings['diagnostics.silence_timeout']
    health = BahrsHealth(converter.signals, settings['diagnostics.rate_tolerance'],
                         silence_timeout, lambda: nvm.status)

    def protocol() -> Mapping[str, str]:
        return {'Protocol version': str(frame_format.version_seen or 'not seen yet'),
                'CRC order': frame_format.order_seen or 'not seen yet'}

    return Sensor(Framer(frame_format), BahrsCodec(settings['pressure_height.format']),
                  _clock(settings), converter, health, TOPICS, LATCHED, protocol,
                  silence_timeout, SILENCE_HINT, nvm)


def _clock(settings: Mapping[str, Any]) -> Clock:
    source, latency = settings['time.source'], round(settings['time.fixed_latency'] * NS_PER_S)
    if source == 'arrival':
        return ArrivalStamps(latency)
    return SampleClock(ClockOptions(
        source, settings['time.label'], latency,
        round(settings['time.sync_pulse.period'] * NS_PER_S),
        settings['time.sync_pulse.reference'] != ROS_CLOCK))


def _options(settings: Mapping[str, Any]) -> BahrsOptions:
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
                            settings['integrity.risk_inflation']),
        orientation_fallback=settings['stddev.orientation_fallback'],
        withhold_incomplete=settings['publish.incomplete'] == 'withhold')
