# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the messages of the BAHRS become in ROS.

An inertial message gives `imu/data_raw`. A navigation message gives everything else, and carries
the stamp of the inertial sample that it was made with, for both are of the same device time. A
signal that is unavailable is not made up: a message with nothing else to say is not published, a
whole quantity is marked as not reported (REP-145), a lone component is NaN.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
import math
from typing import Any, NamedTuple

from bahrs_driver.convert import atmosphere, covariance, magnetic, ros
from bahrs_driver.convert.axes import Convention, Quaternion, quaternion_from_euler
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.convert.pairing import Pairing
from bahrs_driver.protocol.bahrs import Accuracy, Inertial, Navigation
from bahrs_driver.protocol.layout import Vector
from geometry_msgs.msg import PoseWithCovarianceStamped, TwistWithCovarianceStamped
from sensor_msgs.msg import FluidPressure, Imu, MagneticField, NavSatFix
from std_msgs.msg import Float64

TOPICS: dict[str, type] = {
    'imu/data_raw': Imu,
    'imu/data': Imu,
    'imu/mag': MagneticField,
    'static_pressure': FluidPressure,
    'pressure_altitude': NavSatFix,
    'altitude/pose': PoseWithCovarianceStamped,
    'velocity': TwistWithCovarianceStamped,
    'heading': Float64,
}

# The accuracy message comes with every tenth navigation message; without it for this many the
# last one says nothing about the present.
ACCURACY_LIFETIME = 100
_NO_ACCURACY = Accuracy(0, None, None, None, 0)
_UNKNOWN_DEVIATION = math.sqrt(covariance.UNKNOWN_VARIANCE)

Outgoing = Iterator[tuple[str, Any]]


@dataclass(frozen=True)
class BahrsOptions:
    """What the user may choose: frames, axes, assumed deviations (SI) and the magnetic field."""

    frame_id: str
    world_frame_id: str
    convention: Convention
    force_stddev: float
    rate_stddev: float
    height_stddev: float
    velocity_stddev: float
    declination: float
    field_strength: float
    field_dip: float
    publish_field: bool


class _Sample(NamedTuple):
    stamp_ns: int
    force: Vector
    rate: Vector


class BahrsConverter:
    """Turns the stream of device messages into (topic, ROS message) pairs."""

    def __init__(self, options: BahrsOptions) -> None:
        """Convert as the options say."""
        self._options = options
        self._handlers: dict[type, Callable[[Any, int], Outgoing]] = {
            Inertial: self._inertial, Navigation: self._navigation, Accuracy: self._accuracy}
        self.reset()

    def reset(self) -> None:
        """Forget the stream so far; another one begins."""
        self._pairing = Pairing[_Sample]()
        self._deviations = _NO_ACCURACY
        self._deviations_age = 0

    def convert(self, message: object, stamp_ns: int) -> Outgoing:
        """
        Return what a message becomes; nothing for those that no topic carries.

        stamp_ns is the message's time in nanoseconds since the epoch.
        """
        handler = self._handlers.get(type(message))
        return handler(message, stamp_ns) if handler else iter(())

    def _inertial(self, message: Inertial, stamp_ns: int) -> Outgoing:
        body = self._options.convention.body
        force = body(_available(message.specific_force, message.health[:3]))
        rate = body(_available(message.angular_rate, message.health[3:]))
        sample = _Sample(stamp_ns, force, rate)
        self._pairing.inertial(message.sequence, sample)
        if _something_in(force) or _something_in(rate):
            yield 'imu/data_raw', self._imu(sample, None, covariance.NOT_REPORTED)

    def _accuracy(self, message: Accuracy, _stamp_ns: int) -> Outgoing:
        self._deviations = message
        self._deviations_age = 0
        yield from ()

    def _navigation(self, message: Navigation, stamp_ns: int) -> Outgoing:
        self._deviations_age += 1
        if self._deviations_age > ACCURACY_LIFETIME:
            self._deviations = _NO_ACCURACY
        sample = self._pairing.navigation(message.sequence)
        if sample is None:
            sample = _Sample(stamp_ns, ros.NO_VECTOR, ros.NO_VECTOR)
        height, velocity, roll, pitch, heading = (signal.available for signal in message.health)
        if height:
            yield from self._height(message.pressure_height, sample.stamp_ns)
        if velocity:
            yield from self._velocity(message.velocity_down, sample.stamp_ns)
        yield from self._attitude(message, sample, roll and pitch, heading)
        if roll and pitch and heading and self._options.publish_field:
            yield from self._field(message, sample.stamp_ns)
        yield 'heading', ros.number(
            math.degrees(message.magnetic_heading) % 360.0 if heading else math.nan)

    def _height(self, height: float, stamp_ns: int) -> Outgoing:
        options = self._options
        deviation = options.height_stddev
        here = ros.header(stamp_ns, options.frame_id)
        world = ros.header(stamp_ns, options.world_frame_id)
        _, _, z = options.convention.world((0.0, 0.0, -height))
        yield 'static_pressure', ros.fluid_pressure(
            here, atmosphere.pressure(height), atmosphere.pressure_gradient(height) * deviation)
        yield 'pressure_altitude', ros.altitude_fix(here, height, deviation)
        yield 'altitude/pose', ros.height_pose(world, z, deviation)

    def _velocity(self, velocity_down: float, stamp_ns: int) -> Outgoing:
        options = self._options
        _, _, z = options.convention.world((0.0, 0.0, velocity_down))
        yield 'velocity', ros.vertical_twist(
            ros.header(stamp_ns, options.world_frame_id), z, options.velocity_stddev)

    def _attitude(self, message: Navigation, sample: _Sample, level: bool,
                  heading: bool) -> Outgoing:
        if level:
            yaw = message.magnetic_heading + self._options.declination if heading else 0.0
            rotation = quaternion_from_euler(message.roll, message.pitch, yaw)
            orientation = self._options.convention.orientation(rotation)
            yield 'imu/data', self._imu(sample, orientation, self._spread(heading))
        elif _something_in(sample.force) or _something_in(sample.rate):
            yield 'imu/data', self._imu(sample, None, covariance.NOT_REPORTED)

    def _spread(self, heading: bool) -> Matrix:
        """Return the covariance of the orientation, its heading known or not."""
        accuracy = self._deviations
        return covariance.of_orientation(self._options.convention.diagonal(
            (accuracy.north_std, accuracy.east_std,
             accuracy.heading_std if heading else _UNKNOWN_DEVIATION)))

    def _field(self, message: Navigation, stamp_ns: int) -> Outgoing:
        options = self._options
        field, spread = magnetic.derived_field(
            message.roll, message.pitch, message.magnetic_heading, self._deviations.heading_std,
            options.field_strength, options.field_dip, options.convention)
        yield 'imu/mag', ros.magnetic_field(
            ros.header(stamp_ns, options.frame_id), field, spread)

    def _imu(self, sample: _Sample, orientation: Quaternion | None, spread: Matrix) -> Imu:
        options = self._options
        return ros.imu(ros.header(sample.stamp_ns, options.frame_id), orientation, spread,
                       sample.rate, options.rate_stddev, sample.force, options.force_stddev)


def _available(vector: Vector, health: tuple[Any, ...]) -> Vector:
    x, y, z = (value if signal.available else math.nan for value, signal in zip(vector, health))
    return x, y, z


def _something_in(vector: Vector) -> bool:
    return not all(map(math.isnan, vector))
