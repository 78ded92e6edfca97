# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings that every device has. Each device adds its own in devices/DEVICE/settings.py."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from bahrs_driver.settings.group import DeviceSettings, Group, setting


@dataclass(frozen=True)
class Stddev(Group):
    """Assumed standard deviations; 0 is unknown."""

    specific_force: float = setting(
        0.01, 'Standard deviation of each component of the specific force. The default is what a '
        'device at rest shows; a vibrating airframe needs more. 0 is unknown.', 'm/s^2',
        low=0.0, high=100.0)
    angular_rate: float = setting(
        0.0005, 'Standard deviation of each component of the angular rate. The default is what a '
        'device at rest shows; 0 is unknown.', 'rad/s', low=0.0, high=10.0)
    velocity: float = setting(
        0.2, 'Standard deviation of the velocity: of a bahrs the vertical one, of a titan_m each '
        'component; 0 is unknown.', 'm/s', low=0.0, high=100.0)


@dataclass(frozen=True)
class MagneticField(Group):
    """The magnetic field at the device."""

    declination: float = setting(
        0.0, 'Magnetic declination, positive east. It is added to the magnetic heading to give '
        'the yaw of imu/data and odometry, and the accuracy of a bahrs is rotated with it; the '
        'topic heading stays as the device has it.', 'degree', low=-180.0, high=180.0)


@dataclass(frozen=True)
class Publish(Group):
    """Settings of the published messages."""

    incomplete: Literal['nan', 'withhold'] = setting(
        'nan', 'What becomes of a message in which a component is not available: nan publishes it '
        'with NaN in its place, withhold does not publish it, for filters that never recover from '
        'a NaN. NavSatFix messages are published in any case.')
    raw: bool = setting(
        False, 'Whether to publish raw, the bytes of each read as they came. A bag that holds it '
        'holds everything, and can be converted again.')


@dataclass(frozen=True)
class Startup(Group):
    """Settings of the start, before the port is opened."""

    wait_for_subscribers: float = setting(
        0.0, 'Longest time to wait, before the port is opened, until each data topic has a '
        'subscriber: a recorder that was started first then misses nothing. 0 does not wait.',
        's', low=0.0, high=60.0)


@dataclass(frozen=True)
class Diagnostics(Group):
    """Thresholds of the diagnostics."""

    silence_timeout: float = setting(
        1.0, 'Time without a byte, or without a data message, from which on the device is '
        'reported as silent.', 's', low=0.1, high=60.0)
    rate_tolerance: float = setting(
        0.05, 'Share by which the rate of a message may differ from the expected rate without '
        'a warning.', low=0.0, high=1.0)
    damaged_share: float = setting(
        0.1, 'Share of damaged frames above which the line is reported as unusable; below, any '
        'damaged frame is a warning.', low=0.0, high=1.0)
    qualified_name: bool = setting(
        False, 'Whether names in /diagnostics begin with the fully qualified name of the node '
        '(/bahrs_driver: Link) at the root, too. In a namespace they always do '
        '(/left/bahrs_driver: Link).')


@dataclass(frozen=True)
class Time(Group):
    """Settings of the stamps."""

    source: Literal['device', 'sync_pulse', 'arrival'] = setting(
        'device', 'What stamps are made of: device puts device time on ROS time from when samples '
        'arrive (a titan_m has none: the middle of request and answer), sync_pulse does so with '
        'the help of sync pulses, arrival is the time of arrival, for comparison.')
    fixed_latency: float = setting(
        0.0, 'Subtracted from every stamp: the least delay from a sample to its first byte, which '
        'cannot be observed without sync pulses.', 's', low=0.0, high=1.0)


@dataclass(frozen=True)
class CommonSettings(DeviceSettings):
    """The settings that every device has."""

    port: str = setting(
        '/dev/ttyUSB0', 'Serial port: a path, or a URL such as socket://host:4001, '
        'rfc2217://host:4001 or hwgrep://0403:6001.')
    baud_rate: int = setting(115200, 'Speed of the serial line. Always 8N1.', 'baud',
                             low=1200, high=4000000)
    frame_id: str = setting(
        'imu_link', 'Frame of the sensor, in which body vectors are given.', is_frame=True)
    world_frame_id: str = setting(
        'map', 'Frame of altitude/pose, velocity and odometry, level with its z axis vertical.',
        is_frame=True)
    frame_convention: Literal['enu', 'ned'] = setting(
        'enu', 'Axes of published data: enu for body forward, left, up and world east, north, '
        'up (REP-103); ned for body forward, right, down and world north, east, down.')
    stddev: Stddev = Stddev()
    magnetic_field: MagneticField = MagneticField()
    publish: Publish = Publish()
    startup: Startup = Startup()
    diagnostics: Diagnostics = Diagnostics()
    time: Time = Time()

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that have no effect beside the others, each with the reason."""
        if self.port.startswith('socket://'):
            yield 'baud_rate', 'port is a socket'
