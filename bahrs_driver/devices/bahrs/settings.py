# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a BAHRS."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from bahrs_driver.devices import settings as common
from bahrs_driver.devices.nvm_settings import NvmSettings
from bahrs_driver.settings.group import Group, setting

ROS_CLOCK = 'ros_clock'


@dataclass(frozen=True)
class Stddev(common.Stddev):
    """Assumed standard deviations; 0 is unknown."""

    orientation_fallback: float = setting(
        0.1, 'Standard deviation of the orientation of a bahrs about each axis, used while the '
        'device reports no accuracy. 0 means unknown: the covariance is then all zeros, which '
        'some filters take for certainty.', 'rad', low=0.0, high=4.0)
    pressure_height: float = setting(
        1.0, 'Standard deviation of the pressure height. 0 means unknown.', 'm', low=0.0,
        high=1000.0)


@dataclass(frozen=True)
class MagneticField(common.MagneticField):
    """The magnetic field at the device."""

    strength: float = setting(
        50e-6, 'Magnetic field strength that imu/mag is derived with.', 'T', low=0.0, high=1e-3)
    dip: float = setting(
        0.0, 'Magnetic dip that imu/mag is derived with, positive downward. 0 is a horizontal '
        'field.', 'degree', low=-90.0, high=90.0)


@dataclass(frozen=True)
class Publish(common.Publish):
    """Settings of the published messages."""

    derived_magnetic_field: bool = setting(
        True, 'Publish imu/mag, derived from attitude and heading, for a device that does not '
        'report the magnetic field.')


@dataclass(frozen=True)
class Integrity(Group):
    """The treatment of signals at integrity risk."""

    risk_policy: Literal['inflate', 'withhold', 'pass'] = setting(
        'inflate', 'How to publish a signal at integrity risk: inflate increases its variance, '
        'withhold treats it as unavailable, pass publishes it unchanged.')
    risk_inflation: float = setting(
        100.0, 'Factor on the variance of a signal at integrity risk if integrity.risk_policy is '
        'inflate.', low=1.0, high=1e6)


@dataclass(frozen=True)
class SyncPulse(Group):
    """The sync pulses that the device marks."""

    period: float = setting(1.0, 'Time between two sync pulses.', 's', low=0.1, high=60.0)
    reference: str = setting(
        ROS_CLOCK, 'Source of the times of the sync pulses: ros_clock rounds ROS time to the '
        'nearest whole period, for a host clock that is disciplined by the receiver that sends '
        'the pulses; any other value is the name of a sensor_msgs/TimeReference topic that has '
        'the time in its header.')


@dataclass(frozen=True)
class Time(common.Time):
    """How stamps are made."""

    label: Literal['auto', 'next', 'same'] = setting(
        'auto', 'Sample that a time message names: next is the sample after the one whose time it '
        'holds, as real devices send it; same is that sample itself, as the protocol document '
        'says; auto detects it.')
    sync_pulse: SyncPulse = SyncPulse()


@dataclass(frozen=True)
class PressureHeight(Group):
    """The pressure height on the wire."""

    format: Literal['uint16', 'int16'] = setting(  # noqa: A003
        'uint16', 'Format of the pressure height in frames: uint16 as real devices send it, int16 '
        'as the protocol document says.')


@dataclass(frozen=True)
class BahrsSettings(common.CommonSettings):
    """All settings of a BAHRS."""

    stddev: Stddev = Stddev()
    magnetic_field: MagneticField = MagneticField()
    publish: Publish = Publish()
    time: Time = Time()
    integrity: Integrity = Integrity()
    pressure_height: PressureHeight = PressureHeight()
    crc_order: Literal['auto', 'word', 'byte'] = setting(
        'auto', 'Order in which the CRC of a frame takes the bytes: word is in 32-bit words, as '
        'real devices do it; byte is one by one, as the protocol document says; auto detects it.')
    nvm: NvmSettings = NvmSettings()

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that have no effect beside the others, each with the reason."""
        yield from super().unused()
        if not self.publish.derived_magnetic_field:
            for name in ('strength', 'dip'):
                yield f'magnetic_field.{name}', 'publish.derived_magnetic_field is False'
        if self.integrity.risk_policy != 'inflate':
            yield ('integrity.risk_inflation',
                   f'integrity.risk_policy is {self.integrity.risk_policy!r}')
        if self.time.source == 'arrival':
            yield 'time.label', f'time.source is {self.time.source!r}'
        if self.time.source != 'sync_pulse':
            for name in ('period', 'reference'):
                yield f'time.sync_pulse.{name}', f'time.source is {self.time.source!r}'
