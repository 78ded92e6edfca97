# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The settings that every device has. Each device adds its own in devices/DEVICE/settings.py."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Literal, TypeVar

from bahrs_driver.settings.group import DeviceSettings, Group, setting
from bahrs_driver.settings.parameter import OtherDefault


@dataclass(frozen=True)
class Stddev(Group):
    """Assumed standard deviations; 0 is unknown."""

    specific_force: float = setting(
        0.01, 'Standard deviation of each component of the specific force. The default is the '
        'noise of a device at rest; increase it for a vibrating airframe. 0 means unknown.',
        'm/s^2', low=0.0, high=100.0)
    angular_rate: float = setting(
        0.0005, 'Standard deviation of each component of the angular rate. The default is the '
        'noise of a device at rest. 0 means unknown.', 'rad/s', low=0.0, high=10.0)
    velocity: float = setting(
        0.2, 'Standard deviation of the velocity: of the vertical component for a bahrs, of each '
        'component for a titan_m. 0 means unknown.', 'm/s', low=0.0, high=100.0)


@dataclass(frozen=True)
class MagneticField(Group):
    """The magnetic field at the device."""

    declination: float = setting(
        0.0, 'Magnetic declination, positive east. The driver adds it to the magnetic heading to '
        'get the yaw of imu/data and odometry, and rotates the orientation accuracy of a bahrs by '
        'it. The topic heading is published as the device sends it.', 'degree', low=-180.0,
        high=180.0)


@dataclass(frozen=True)
class Publish(Group):
    """Settings of the published messages."""

    incomplete: Literal['nan', 'not_reported', 'withhold'] = setting(
        'nan', 'How to publish a message with an unavailable component: nan publishes it with NaN '
        'for this component; not_reported also marks the force or rate of an Imu message that it '
        'belongs to as not reported (-1), for filters that obey this mark; withhold drops the '
        'message, for filters that do not recover from NaN. NavSatFix messages are always '
        'published.')
    static_tf: bool = setting(
        False, 'Publish the transform from base_frame_id to frame_id on /tf_static, as the '
        'parameters mounting describe it. The launch files set it to true by default.',
        in_file=False)
    tf: bool = setting(
        False, 'Publish the attitude as the transform from world_frame_id to base_frame_id on '
        '/tf, with a translation of zero, while roll, pitch and heading are available. Leave it '
        'off if an estimator such as robot_localization publishes the pose of base_frame_id.')
    raw: bool = setting(
        False, 'Publish the topic raw, the received bytes. A bag needs only this topic: bahrs '
        'convert regenerates all others from it.')


@dataclass(frozen=True)
class Mounting(Group):
    """The pose of the device in base_frame_id."""

    x: float = setting(0.0, 'Position of the device in base_frame_id, forward.', 'm', low=-1000.0,
                       high=1000.0)
    y: float = setting(0.0, 'Position of the device in base_frame_id, to the left.', 'm',
                       low=-1000.0, high=1000.0)
    z: float = setting(0.0, 'Position of the device in base_frame_id, upward.', 'm', low=-1000.0,
                       high=1000.0)
    roll: float = setting(
        0.0, 'Roll of the device in base_frame_id: the last of its rotations, about x. Leave it '
        '0 if the device itself corrects for its mounting, by installation angles in its memory.',
        'rad', low=-7.0, high=7.0)
    pitch: float = setting(
        0.0, 'Pitch of the device in base_frame_id: the second of its rotations, about y.', 'rad',
        low=-7.0, high=7.0)
    yaw: float = setting(
        0.0, 'Yaw of the device in base_frame_id: the first of its rotations, about z.', 'rad',
        low=-7.0, high=7.0)


@dataclass(frozen=True)
class Startup(Group):
    """Settings of the start, before the port is opened."""

    wait_for_subscribers: float = setting(
        0.0, 'Longest time to wait, before the port is opened, until each data topic has a '
        'subscriber. A recorder that was started first then misses no messages. 0 does not wait. '
        'The launch files wait 10 s by default if they start a recorder.', 's', low=0.0, high=60.0,
        in_file=False)


@dataclass(frozen=True)
class Diagnostics(Group):
    """Thresholds of the diagnostics."""

    silence_timeout: float = setting(
        1.0, 'Time without a byte, or without a data message, after which the device is reported '
        'as silent.', 's', low=0.1, high=60.0)
    rate_tolerance: float = setting(
        0.05, 'Largest deviation of a message rate from the expected rate, as a fraction of it, '
        'without a warning.', low=0.0, high=1.0)
    damaged_share: float = setting(
        0.1, 'Fraction of damaged frames above which the line is reported as unusable. Below it, '
        'damaged frames are only a warning.', low=0.0, high=1.0)
    qualified_name: bool = setting(
        False, 'Begin names in /diagnostics with the fully qualified node name (/bahrs_driver: '
        'Link) also in the root namespace. In other namespaces they always begin with it '
        '(/left/bahrs_driver: Link).')


@dataclass(frozen=True)
class Time(Group):
    """Settings of the stamps."""

    source: Literal['device', 'sync_pulse', 'arrival'] = setting(
        'device', 'Source of the stamps: device converts device time to ROS time, with an offset '
        'estimated from the arrival of the samples (a titan_m sends no device time: its stamps '
        'are the middle between request and answer); sync_pulse also uses sync pulses; arrival is '
        'the time of arrival, for comparison.')
    fixed_latency: float = setting(
        0.0, 'Latency to subtract from every stamp: the shortest delay from a sample to its first '
        'byte, which cannot be measured without sync pulses.', 's', low=0.0, high=1.0)


Settings = TypeVar('Settings', bound='CommonSettings')


@dataclass(frozen=True)
class CommonSettings(DeviceSettings):
    """The settings that every device has."""

    port: str = setting(
        '/dev/ttyUSB0', 'Serial port: a path, or a URL such as socket://host:4001, '
        'rfc2217://host:4001 or hwgrep://0403:6001.')
    baud_rate: int = setting(
        115200, 'Speed of the serial line. The line is always 8N1.', 'baud', low=1200,
        high=4000000)
    frame_id: str = setting(
        'imu_link', 'Frame of the sensor. Body vectors are given in this frame. The default is '
        'imu_link_ned if frame_convention is ned.', is_frame=True, in_file=False,
        other_default=OtherDefault('frame_convention', 'ned', 'imu_link_ned'))
    world_frame_id: str = setting(
        'odom', 'Frame of altitude/pose, velocity and odometry. Its z axis is vertical. The '
        'default is map_ned if frame_convention is ned.', is_frame=True, in_file=False,
        other_default=OtherDefault('frame_convention', 'ned', 'map_ned'))
    base_frame_id: str = setting(
        'base_link', 'Frame of the vehicle, for transforms. Its axes are forward, left, up, '
        'whatever frame_convention is.', is_frame=True)
    frame_convention: Literal['enu', 'ned'] = setting(
        'enu', 'Axes of the published data: enu is forward, left, up for the body and east, '
        'north, up for the world (REP-103); ned is forward, right, down for the body and north, '
        'east, down for the world.')
    stddev: Stddev = Stddev()
    mounting: Mounting = Mounting()
    magnetic_field: MagneticField = MagneticField()
    publish: Publish = Publish()
    startup: Startup = Startup()
    diagnostics: Diagnostics = Diagnostics()
    time: Time = Time()

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that have no effect beside the others, each with the reason."""
        if self.port.startswith('socket://'):
            yield 'baud_rate', 'port is a socket'
        if not self.publish.tf and not self.publish.static_tf:
            for name in ('base_frame_id', *(f'mounting.{item.name}' for item in fields(Mounting))):
                yield name, 'publish.tf and publish.static_tf are False'

    def for_recording(self: Settings) -> Settings:
        """Return the settings without transforms, which a conversion does not publish."""
        return replace(self, publish=replace(self.publish, tf=False, static_tf=False))
