# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert the messages of the BAHRS to values of ROS messages.

An inertial message becomes `imu/data_raw`. A navigation message becomes all other topics, with the
stamp of the inertial sample that it was computed from, because both have the same device time. No
value replaces an unavailable signal: a topic without any available signal is not published, except
for the Imu messages, in which a whole quantity is marked as not reported (REP-145) and a single
component is NaN.
"""

from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
import math
from typing import NamedTuple

from bahrs_driver.clock.navigation import NavigationCounter
from bahrs_driver.convert import atmosphere, covariance, values
from bahrs_driver.convert.axes import (
    Convention, NO_ROTATION, Quaternion, quaternion_from_euler, same_sign,
)
from bahrs_driver.convert.bahrs import magnetic
from bahrs_driver.convert.bahrs.integrity_notice import IntegrityNotice
from bahrs_driver.convert.bahrs.integrity_policy import (
    IntegrityPolicy, mask_unavailable, VarianceFactor,
)
from bahrs_driver.convert.bahrs.orientation_accuracy import OrientationAccuracy
from bahrs_driver.convert.completeness import without_incomplete
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.convert.outgoing import ALL_TOPICS, Outgoing
from bahrs_driver.convert.transforms import Mounting, TF
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, Inertial, InertialTime, Navigation, SyncPulseTime,
)
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.layout import Vector
from bahrs_driver.units import NS_PER_US, ROS_TIME_END_S, US_PER_S

TOPICS: dict[str, type] = {
    'imu/data_raw': values.Imu,
    'imu/data': values.Imu,
    'imu/mag': values.MagneticField,
    'static_pressure': values.FluidPressure,
    'pressure_altitude': values.NavSatFix,
    'altitude/pose': values.PoseWithCovarianceStamped,
    'velocity': values.TwistWithCovarianceStamped,
    'attitude/rpy': values.Vector3Stamped,
    'heading': values.Float64,
    'integrity': values.DiagnosticArray,
    'time_reference': values.TimeReference,
    'sync_pulse': values.TimeReference,
}
NAVIGATION_TOPICS = {*TOPICS, TF} - {'imu/data_raw', 'integrity', 'time_reference', 'sync_pulse'}
# A late subscriber receives the last message of these.
LATCHED = {'integrity'}

TIME_SOURCE = 'bahrs'
MAX_STAMP_DIFFERENCE = 500_000_000      # ns of a message after its inertial sample
LONGEST_TIME_US = ROS_TIME_END_S * US_PER_S


@dataclass(frozen=True)
class BahrsOptions:
    """The options: frames, axes, assumed standard deviations (SI), field and risk policy."""

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
    integrity_policy: IntegrityPolicy
    orientation_fallback: float = 0.0       # rad; 0 is unknown
    withhold_incomplete: bool = False
    whole_vectors: bool = False             # without a component, a vector is not reported
    mounting: Mounting | None = None        # if the attitude is published on /tf


class _Sample(NamedTuple):
    """An inertial sample in published axes, with NaN for unavailable components."""

    force: Vector
    force_covariance: Matrix
    rate: Vector
    rate_covariance: Matrix


_NO_SAMPLE = _Sample(values.NO_VECTOR, covariance.NOT_REPORTED,
                     values.NO_VECTOR, covariance.NOT_REPORTED)


class BahrsConverter:
    """Converts the stream of device messages to topics and their values."""

    def __init__(self, options: BahrsOptions) -> None:
        self._options = options
        self.select(ALL_TOPICS)
        self._accuracy = OrientationAccuracy(
            options.convention, options.declination, options.orientation_fallback)
        self._notice = IntegrityNotice(Inertial.SIGNALS + Navigation.SIGNALS)
        self._handlers: dict[type, Callable[..., Outgoing]] = {
            Inertial: self._inertial, Navigation: self._navigation, Accuracy: self._store_accuracy,
            InertialTime: self._time, SyncPulseTime: self._pulse}
        self._forget()

    @property
    def signals(self) -> Mapping[str, Integrity | None]:
        """Present integrity of each signal; None if none was received."""
        return self._notice.signals

    def select(self, topics: Container[str]) -> None:
        """Convert only for these topics from now on; notices of integrity are never left out."""
        self._topics = topics
        self._idle = not any(topic in topics for topic in NAVIGATION_TOPICS)

    def end_stream(self, stamp_ns: int) -> Outgoing:
        """Forget the stream; return the notice that no signal is known, at the present time."""
        self._forget()
        notice = self._notice.forget(stamp_ns, self._options.frame_id)
        return iter([('integrity', notice)] if notice else [])

    def report_silence(self, stamp_ns: int) -> Outgoing:
        """Return the notice that no signal is known any more, at the present time."""
        notice = self._notice.forget(stamp_ns, self._options.frame_id) \
            if self._notice.known else None
        return iter([('integrity', notice)] if notice else [])

    def convert(self, message: object, stamp_ns: int) -> Outgoing:
        """
        Convert a message; the result is empty for messages without a topic.

        stamp_ns is the message's time in nanoseconds since the epoch.
        """
        handler = self._handlers.get(type(message))
        outgoing = handler(message, stamp_ns) if handler else iter(())
        return without_incomplete(outgoing) if self._options.withhold_incomplete else outgoing

    def _forget(self) -> None:
        self._pairing = NavigationCounter(ROLES.samples_per_navigation, prior=0)
        self._latest: tuple[Inertial, int] | None = None    # inertial message, stamp
        self._converted: tuple[Inertial | None, _Sample] = None, _NO_SAMPLE
        self._accuracy.reset()
        self._orientation = NO_ROTATION
        self._navigation_stamp = 0

    def _inertial(self, message: Inertial, stamp_ns: int) -> Outgoing:
        self._latest = message, stamp_ns
        yield from self._changes(message, stamp_ns)
        if 'imu/data_raw' in self._topics:
            yield 'imu/data_raw', self._imu(
                stamp_ns, self._sample(message), None, covariance.NOT_REPORTED)

    def _sample(self, message: Inertial) -> _Sample:
        """Return the sample of a message, mostly that of the last call."""
        last, sample = self._converted
        if message is not last:
            sample = self._convert_sample(message)
            self._converted = message, sample
        return sample

    def _convert_sample(self, message: Inertial) -> _Sample:
        options = self._options
        factors = options.integrity_policy.variance_factors(message.health)
        force, rate = self._whole(factors[:3]), self._whole(factors[3:])
        return _Sample(
            options.convention.body(mask_unavailable(message.specific_force, force)),
            covariance.of_vector(force, options.force_stddev),
            options.convention.body(mask_unavailable(message.angular_rate, rate)),
            covariance.of_vector(rate, options.rate_stddev))

    def _whole(self, factors: tuple[VarianceFactor, ...]) -> tuple[VarianceFactor, ...]:
        """Return the factors of a vector, all None if that is asked for and one is."""
        return (None,) * 3 if self._options.whole_vectors and None in factors else factors

    def _time(self, message: InertialTime, stamp_ns: int) -> Outgoing:
        if message.valid:
            yield from self._reference('time_reference', message.device_time_us, stamp_ns)

    def _pulse(self, message: SyncPulseTime, stamp_ns: int) -> Outgoing:
        yield from self._reference('sync_pulse', message.device_time_us, stamp_ns)

    def _reference(self, topic: str, device_time_us: int, stamp_ns: int) -> Outgoing:
        if device_time_us < LONGEST_TIME_US:
            yield topic, values.TimeReference(
                stamp_ns, self._options.frame_id, device_time_us * NS_PER_US, TIME_SOURCE)

    def _store_accuracy(self, message: Accuracy, _stamp_ns: int) -> Outgoing:
        self._accuracy.update(message)
        return iter(())

    def _navigation(self, message: Navigation, stamp_ns: int) -> Outgoing:
        self._accuracy.count_navigation()
        inertial, stamp_ns = self._sample_of(message, stamp_ns)
        yield from self._changes(message, stamp_ns)
        if self._idle:
            return
        height_factor, velocity_factor, roll_factor, pitch_factor, heading_factor = \
            self._options.integrity_policy.variance_factors(message.health)
        if height_factor is not None:
            yield from self._height(message.pressure_height, height_factor, stamp_ns)
        if velocity_factor is not None and 'velocity' in self._topics:
            yield 'velocity', self._velocity(message.velocity_down, velocity_factor, stamp_ns)
        tilt_factor = None if roll_factor is None or pitch_factor is None \
            else max(roll_factor, pitch_factor)
        orientation = self._attitude(message, tilt_factor, heading_factor)
        yield from self._transform(orientation[0], heading_factor, stamp_ns)
        if 'imu/data' in self._topics:
            sample = self._sample(inertial) if inertial else _NO_SAMPLE
            yield 'imu/data', self._imu(stamp_ns, sample, *orientation)
        if tilt_factor is not None and heading_factor is not None \
                and self._options.publish_field and 'imu/mag' in self._topics:
            yield 'imu/mag', self._field(message, max(tilt_factor, heading_factor), stamp_ns)
        yield from self._angles(message, (roll_factor, pitch_factor, heading_factor), stamp_ns)

    def _sample_of(self, message: Navigation, stamp_ns: int) -> tuple[Inertial | None, int]:
        """Return the inertial message of a navigation message, if known, and their stamp."""
        paired = self._paired(message.sequence)
        if paired is None or stamp_ns - paired[1] > MAX_STAMP_DIFFERENCE:
            inertial = None
        else:
            inertial, sampled_ns = paired
            if sampled_ns != self._navigation_stamp:        # not a repeated frame
                stamp_ns = sampled_ns
        self._navigation_stamp = stamp_ns
        return inertial, stamp_ns

    def _paired(self, navigation: int) -> tuple[Inertial, int] | None:
        """Return the latest sample if a navigation message was computed from it."""
        if self._latest is None:
            return None
        sequence = self._latest[0].sequence
        self._pairing.pair(navigation, sequence)
        return self._latest if self._pairing.matches(navigation, sequence) else None

    def _changes(self, message: Inertial | Navigation, stamp_ns: int) -> Outgoing:
        notice = self._notice.update(message.SIGNALS, message.health, stamp_ns,
                                     self._options.frame_id)
        if notice is not None:
            yield 'integrity', notice

    def _height(self, height: float, factor: float, stamp_ns: int) -> Outgoing:
        options, topics = self._options, self._topics
        deviation = options.height_stddev * math.sqrt(factor)
        if 'static_pressure' in topics:
            pressure_deviation = atmosphere.pressure_gradient(height) * deviation
            yield 'static_pressure', values.FluidPressure(
                stamp_ns, options.frame_id, atmosphere.pressure(height), pressure_deviation ** 2)
        if 'pressure_altitude' in topics:
            yield 'pressure_altitude', values.altitude_fix(
                stamp_ns, options.frame_id, height, deviation)
        if 'altitude/pose' in topics:
            _, _, z = options.convention.world((0.0, 0.0, -height))
            yield 'altitude/pose', values.height_pose(
                stamp_ns, options.world_frame_id, z, deviation)

    def _velocity(self, velocity_down: float, factor: float,
                  stamp_ns: int) -> values.TwistWithCovarianceStamped:
        options = self._options
        _, _, z = options.convention.world((0.0, 0.0, velocity_down))
        return values.vertical_twist(stamp_ns, options.world_frame_id, z,
                                     options.velocity_stddev * math.sqrt(factor))

    def _attitude(self, message: Navigation, tilt_factor: VarianceFactor,
                  heading_factor: VarianceFactor) -> tuple[Quaternion | None, Matrix]:
        """Return the orientation with the sign that is nearest to the last, and its covariance."""
        if tilt_factor is None:
            return None, covariance.NOT_REPORTED
        yaw = 0.0 if heading_factor is None \
            else message.magnetic_heading + self._options.declination
        rotation = quaternion_from_euler(message.roll, message.pitch, yaw)
        self._orientation = same_sign(self._options.convention.orientation(rotation),
                                      self._orientation)
        return self._orientation, self._accuracy.matrix(tilt_factor, heading_factor)

    def _angles(self, message: Navigation, factors: tuple[VarianceFactor, ...],
                stamp_ns: int) -> Outgoing:
        """Yield roll, pitch, yaw and the magnetic heading; an unavailable angle is NaN."""
        options, topics = self._options, self._topics
        roll, pitch, heading = mask_unavailable(
            (message.roll, message.pitch, message.magnetic_heading), factors)
        if 'attitude/rpy' in topics:
            yield 'attitude/rpy', values.Vector3Stamped(
                stamp_ns, options.frame_id,
                options.convention.angles((roll, pitch, heading + options.declination)))
        if 'heading' in topics:
            yield 'heading', values.Float64(math.degrees(heading) % 360.0)

    def _transform(self, orientation: Quaternion | None, heading_factor: VarianceFactor,
                   stamp_ns: int) -> Outgoing:
        mounting = self._options.mounting
        if orientation and heading_factor is not None and mounting and TF in self._topics:
            yield TF, mounting.attitude(stamp_ns, self._options.world_frame_id, orientation)

    def _field(self, message: Navigation, factor: float, stamp_ns: int) -> values.MagneticField:
        options, accuracy = self._options, self._accuracy
        field, spread = magnetic.derived_field(
            message.roll, message.pitch, message.magnetic_heading, accuracy.heading(factor),
            options.field_strength, options.field_dip, options.convention, accuracy.north(factor))
        return values.MagneticField(stamp_ns, options.frame_id, field, spread)

    def _imu(self, stamp_ns: int, sample: _Sample, orientation: Quaternion | None,
             spread: Matrix) -> values.Imu:
        return values.imu(
            stamp_ns, self._options.frame_id, orientation, spread, sample.rate,
            sample.rate_covariance, sample.force, sample.force_covariance)
