# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a Titan-M."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

from bahrs_driver.devices import settings as common
from bahrs_driver.settings.group import Group, setting

ByteOrder = Literal['auto', 'little', 'big']
RATES = ('state.rate', 'sensors.rate', 'gps.rate')
# Parameters that only one kind of answer needs.
OF_STATE = ('stddev.attitude', 'stddev.heading', 'magnetic_field.declination', 'publish.tf')
OF_SENSORS = ('stddev.specific_force', 'stddev.magnetic_field', 'stddev.static_pressure',
              'stddev.differential_pressure', 'stddev.temperature')
OF_GPS = ('gps.week', 'gps.leap_seconds', 'gps.geoid_height')


@dataclass(frozen=True)
class Stddev(common.Stddev):
    """Assumed standard deviations; 0 is unknown."""

    attitude: float = setting(
        0.02, 'Assumed standard deviation of roll and pitch of a titan_m. 0 means unknown.', 'rad',
        low=0.0, high=4.0)
    heading: float = setting(
        0.05, 'Assumed standard deviation of the heading of a titan_m. 0 means unknown.', 'rad',
        low=0.0, high=4.0)
    position: float = setting(
        2.5, 'Standard deviation of each horizontal component of the GPS position. 0 means '
        'unknown.', 'm', low=0.0, high=1000.0)
    altitude: float = setting(
        5.0, 'Standard deviation of the GPS altitude. 0 means unknown.', 'm', low=0.0, high=1000.0)
    magnetic_field: float = setting(
        0.0, 'Standard deviation of each component of the measured magnetic field. 0 means '
        'unknown.', 'T', low=0.0, high=1e-3)
    static_pressure: float = setting(
        0.0, 'Standard deviation of the measured static pressure. 0 means unknown.', 'Pa', low=0.0,
        high=1e5)
    differential_pressure: float = setting(
        0.0, 'Standard deviation of the differential pressure. 0 means unknown.', 'Pa', low=0.0,
        high=1e5)
    temperature: float = setting(
        0.0, 'Standard deviation of the temperature. 0 means unknown.', 'K', low=0.0, high=100.0)


@dataclass(frozen=True)
class State(Group):
    """The answers that hold the state."""

    rate: float = setting(
        50.0, 'Rate at which the driver requests the state (attitude, velocity, position) of a '
        'titan_m. 0 sends no requests.', 'Hz', low=0.01, high=1000.0, or_zero=True)


@dataclass(frozen=True)
class Sensors(Group):
    """The answers that hold what the sensors measure."""

    rate: float = setting(
        50.0, 'Rate at which the driver requests the sensor measurements of a titan_m. 0 sends no '
        'requests.', 'Hz', low=0.01, high=1000.0, or_zero=True)


@dataclass(frozen=True)
class Gps(Group):
    """The answers of the GPS, and its time."""

    rate: float = setting(
        10.0, 'Rate at which the driver requests the GPS position of a titan_m. 0 sends no '
        'requests.', 'Hz', low=0.01, high=1000.0, or_zero=True)
    week: int = setting(
        0, 'GPS week (since 1980, without rollover) at the start of the driver, for a host whose '
        'clock is not set. 0 means unknown. If the clock is set, the driver uses the week nearest '
        'to it and reports a gps.week that contradicts it.', low=0, high=3000)
    leap_seconds: int = setting(
        18, 'GPS time minus UTC, for time_reference.', 's', low=0, high=100)
    geoid_height: float = setting(
        0.0, 'Height of the geoid above the ellipsoid, added to the altitude of fix. Set it if '
        'the device sends altitudes above mean sea level; its protocol document does not say.',
        'm', low=-200.0, high=200.0)


@dataclass(frozen=True)
class Request(Group):
    """How requests are sent."""

    pipelined: bool = setting(
        False, 'Allow one pending request of each kind, instead of one in total. It helps with '
        'adapters that hold bytes back, if the device supports it.')
    timeout: float = setting(
        0.2, 'Longest time to wait for an answer. The driver shortens it once it knows the '
        'response time of the device.', 's', low=0.01, high=5.0)
    retries: int = setting(
        1, 'Number of times that an unanswered request is repeated.', low=0, high=10)
    message_id: Literal['zero', 'counted'] = setting(
        'zero', 'Message id of requests: zero, byte for byte as in the protocol document; '
        'counted, to identify late answers if the device returns the ids.')


@dataclass(frozen=True)
class TitanMSettings(common.CommonSettings):
    """All settings of a Titan-M."""

    stddev: Stddev = Stddev()
    state: State = State()
    sensors: Sensors = Sensors()
    gps: Gps = Gps()
    request: Request = Request()
    payload_order: ByteOrder = setting(
        'auto', 'Byte order of the payloads of a titan_m. auto detects it from plausible values '
        'and holds all answers until then.')
    checksum_order: ByteOrder = setting(
        'auto', 'Byte order of the checksums of a titan_m. auto accepts both in answers; in '
        'requests it tries big, as printed in the protocol document, then little.')

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that have no effect beside the others, each with the reason."""
        yield from super().unused()
        rates = self.state.rate, self.sensors.rate, self.gps.rate
        if not any(rates):
            for name in ('pipelined', 'timeout', 'retries', 'message_id'):
                yield f'request.{name}', f'{", ".join(RATES)} are 0'
            return
        for parameter, rate, names in zip(RATES, rates, (OF_STATE, OF_SENSORS, OF_GPS)):
            if not rate:
                yield from ((name, f'{parameter} is 0') for name in names)

    def for_recording(self) -> 'TitanMSettings':
        """Return the settings with which a driver requests nothing, as in a conversion."""
        return replace(super().for_recording(), state=replace(self.state, rate=0.0),
                       sensors=replace(self.sensors, rate=0.0), gps=replace(self.gps, rate=0.0))

    def for_file(self) -> 'TitanMSettings':
        """Return the settings that the parameter file in config/ recommends."""
        return replace(self, stddev=replace(
            self.stddev, specific_force=0.05, angular_rate=0.002))      # never measured at rest
