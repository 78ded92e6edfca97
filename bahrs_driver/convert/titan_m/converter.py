# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert the answers of the Titan-M to values of ROS messages.

Each answer is a measurement with its own stamp. `imu/data` has the attitude and stamp of a state
answer, with the calibrated force and rate of the sensor answer just before it. NaN and infinity
are not reported.

The document defines velocity north and east and heading, and uses UTM only for the position. So
they refer to true north, without the convergence of the grid.
"""

from collections.abc import Callable, Collection, Container
from dataclasses import dataclass
import math
from typing import NamedTuple

from bahrs_driver.convert import covariance, values
from bahrs_driver.convert.axes import (
    Convention, NO_ROTATION, Quaternion, quaternion_from_euler, rotate_to_body, same_sign,
)
from bahrs_driver.convert.completeness import without_incomplete
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.convert.outgoing import ALL_TOPICS, Outgoing
from bahrs_driver.convert.titan_m.gps_status import GpsStatus
from bahrs_driver.convert.titan_m.gps_time import GpsTime
from bahrs_driver.convert.transforms import Mounting, TF
from bahrs_driver.convert.utm import load_pyproj, to_wgs84
from bahrs_driver.protocol.layout import Vector
from bahrs_driver.protocol.titan_m.messages import (
    ADC_FORCE, ADC_RATE_DEG, Gps, Sensors, State, TitanAnswer,
)
from bahrs_driver.units import NS_PER_US

TOPICS: dict[str, type] = {
    'imu/data_raw': values.Imu,
    'imu/data': values.Imu,
    'imu/mag': values.MagneticField,
    'static_pressure': values.FluidPressure,
    'differential_pressure': values.FluidPressure,
    'temperature': values.Temperature,
    'fix': values.NavSatFix,
    'velocity': values.TwistWithCovarianceStamped,
    'odometry': values.Odometry,
    'attitude/rpy': values.Vector3Stamped,
    'heading': values.Float64,
    'time_reference': values.TimeReference,
}
LATCHED: set[str] = set()

ABSENT_NS = 2_000_000_000       # after which a kind of answer that never came is not requested
TOGETHER_NS = 25_000_000        # between sensor and state answer that form one imu/data
TIME_SOURCE = 'gps'
ADC_RATE = math.radians(ADC_RATE_DEG)   # rad/s
ROUNDING = math.sqrt(1 / 12)            # standard deviation of a rounding error, in quanta


@dataclass(frozen=True)
class TitanDeviations:
    """Assumed standard deviations (SI); 0 is unknown."""

    force: float
    rate: float
    attitude: float
    heading: float
    velocity: float
    position: float
    altitude: float
    field: float
    static_pressure: float
    differential_pressure: float
    temperature: float


@dataclass(frozen=True)
class TitanOptions:
    """The options: frames, axes, standard deviations; angles in rad, heights in m."""

    frame_id: str
    world_frame_id: str
    convention: Convention
    deviations: TitanDeviations
    declination: float
    geoid_height: float
    gps_week: int
    leap_seconds: int
    # Without state answers, velocity is that of the GPS. Only GPS answers report the fix.
    requested: Collection[type[TitanAnswer]] | None     # None: another host sends the requests
    withhold_incomplete: bool = False
    mounting: Mounting | None = None        # if the attitude is published on /tf


class _Sample(NamedTuple):
    """Calibrated force and rate in published axes."""

    stamp_ns: int
    force: Vector
    rate: Vector


class TitanConverter:
    """Converts answers to topics and their values."""

    def __init__(self, options: TitanOptions) -> None:
        load_pyproj()
        self._options = options
        self._topics: Container[str] = ALL_TOPICS
        self._gps_time = GpsTime(options.gps_week, options.leap_seconds)
        self._handlers: dict[type, Callable[..., Outgoing]] = {
            State: self._state, Gps: self._gps, Sensors: self._sensors}
        deviations = options.deviations
        self._orientation_covariance = covariance.of_orientation(options.convention.diagonal(
            (deviations.attitude, deviations.attitude, deviations.heading)))
        self._covariances = _diagonal(deviations.force), _diagonal(deviations.rate)
        self._raw_covariances = (_diagonal(math.hypot(deviations.force, ADC_FORCE * ROUNDING)),
                                 _diagonal(math.hypot(deviations.rate, ADC_RATE * ROUNDING)))
        self._forget()

    def select(self, topics: Container[str]) -> None:
        """Return values only for these topics from now on."""
        self._topics = topics

    def end_stream(self, _stamp_ns: int) -> Outgoing:
        """Forget the stream; no message reports its end."""
        self._forget()
        return iter(())

    def report_silence(self, _stamp_ns: int) -> Outgoing:
        """Return nothing: no topic reports a pause."""
        return iter(())

    def convert(self, message: object, stamp_ns: int) -> Outgoing:
        """
        Convert an answer; the result is empty for one that is not decoded.

        stamp_ns is the answer's time in nanoseconds since the epoch.
        """
        outgoing = self._selected(self._convert(message, stamp_ns))
        return without_incomplete(outgoing) if self._options.withhold_incomplete else outgoing

    def _selected(self, outgoing: Outgoing) -> Outgoing:
        return (pair for pair in outgoing if pair[0] in self._topics)

    def _convert(self, message: object, stamp_ns: int) -> Outgoing:
        handler = self._handlers.get(type(message))
        if handler:
            self._first_stamps.setdefault(type(message), stamp_ns)
            yield from handler(message, stamp_ns)

    @property
    def gps_status(self) -> GpsStatus:
        """Present status of the GPS."""
        return self._gps_status

    @property
    def week_problem(self) -> str:
        """Sentence about a wrong or unknown GPS week; empty if it is right."""
        return self._gps_time.problem

    def take_notices(self) -> list[str]:
        """Return sentences for the log since the last call."""
        return self._gps_time.take_notices()

    def _forget(self) -> None:
        self._orientation = NO_ROTATION
        self._sample: _Sample | None = None
        self._had_fix = False
        self._gps_status = GpsStatus()
        self._first_stamps: dict[type, int] = {}    # of each kind of answer

    def _expects(self, kind: type[TitanAnswer], stamp_ns: int) -> bool:
        """Return whether answers of a kind arrive, or may still begin to arrive."""
        if self._options.requested is not None:
            return kind in self._options.requested
        first = self._first_stamps
        return kind in first or stamp_ns - min(first.values()) < ABSENT_NS

    def _sensors(self, message: Sensors, stamp_ns: int) -> Outgoing:
        options, deviations = self._options, self._options.deviations
        frame_id, body = options.frame_id, options.convention.body
        x, y, z = message.adc_angular_rate_deg
        yield 'imu/data_raw', self._imu(
            stamp_ns, None, body(message.adc_acceleration),
            body((math.radians(x), math.radians(y), math.radians(z))), self._raw_covariances)
        self._sample = _Sample(stamp_ns, body(_numbers(message.acceleration)),
                               body(_numbers(message.angular_rate)))
        if any(message.magnetic_field_tesla):
            yield 'imu/mag', values.MagneticField(
                stamp_ns, frame_id, body(message.magnetic_field_tesla),
                covariance.diagonal((deviations.field ** 2,) * 3))
        if message.absolute_pressure:
            yield 'static_pressure', values.FluidPressure(
                stamp_ns, frame_id, message.absolute_pressure, deviations.static_pressure ** 2)
        yield 'differential_pressure', values.FluidPressure(
            stamp_ns, frame_id, message.differential_pressure,
            deviations.differential_pressure ** 2)
        yield 'temperature', values.Temperature(
            stamp_ns, frame_id, message.temperature_c, deviations.temperature ** 2)

    def _state(self, message: State, stamp_ns: int) -> Outgoing:
        options = self._options
        roll, pitch, heading = message.attitude
        rotation = quaternion_from_euler(
            roll, pitch, heading + options.declination) if _finite(message.attitude) else None
        if rotation:
            self._orientation = same_sign(options.convention.orientation(rotation),
                                          self._orientation)
            if options.mounting:
                yield TF, options.mounting.attitude(
                    stamp_ns, options.world_frame_id, self._orientation)
        force = rate = values.NO_VECTOR
        if self._sample and abs(stamp_ns - self._sample.stamp_ns) <= TOGETHER_NS:
            _, force, rate = self._sample
        yield 'imu/data', self._imu(
            stamp_ns, self._orientation if rotation else None, force, rate, self._covariances)
        if _finite(message.velocity_ned):
            yield 'velocity', self._twist(message.velocity_ned, stamp_ns)
        if rotation and _finite(message.position_ned + message.velocity_ned) \
                and (self._had_fix or not self._expects(Gps, stamp_ns)):
            yield 'odometry', self._odometry(message, rotation, stamp_ns)
        yield 'attitude/rpy', values.Vector3Stamped(
            stamp_ns, options.frame_id, options.convention.angles(
                (roll, pitch, heading + options.declination)) if rotation else values.NO_VECTOR)
        yield 'heading', values.Float64(
            math.degrees(heading) % 360.0 if rotation else math.nan)

    def _gps(self, message: Gps, stamp_ns: int) -> Outgoing:
        options = self._options
        position = to_wgs84(message.easting, message.northing, message.zone, message.northern)
        yield 'fix', values.position_fix(
            stamp_ns, options.frame_id, position, message.altitude + options.geoid_height,
            options.deviations.position, options.deviations.altitude)
        if position:
            self._had_fix = True
            if not self._expects(State, stamp_ns):
                yield 'velocity', self._twist(message.velocity_ned, stamp_ns)
        self._gps_status = GpsStatus(True, message.zone if position else 0, message.northern)
        # A time of 0 is unknown, and cannot be compared with the GPS week.
        time = self._gps_time.utc_us(message.gps_time_s, stamp_ns) if message.gps_time_s else None
        if time is not None:
            yield 'time_reference', values.TimeReference(
                stamp_ns, options.frame_id, time * NS_PER_US, TIME_SOURCE)

    def _twist(self, velocity: Vector, stamp_ns: int) -> values.TwistWithCovarianceStamped:
        options = self._options
        return values.twist(stamp_ns, options.world_frame_id,
                            options.convention.world(velocity), options.deviations.velocity)

    def _odometry(self, message: State, rotation: Quaternion, stamp_ns: int) -> values.Odometry:
        options, deviations = self._options, self._options.deviations
        c = self._orientation_covariance
        rate = (deviations.rate ** 2 if _finite(message.angular_rate)
                else covariance.UNKNOWN_VARIANCE)
        position = (deviations.position ** 2, deviations.position ** 2, deviations.altitude ** 2)
        return values.odometry(
            stamp_ns, options.world_frame_id, options.frame_id,
            options.convention.world(message.position_ned),
            self._orientation,
            covariance.of_pairs(position, (c[0], c[4], c[8])),
            options.convention.body(rotate_to_body(message.velocity_ned, rotation)),
            options.convention.body(_numbers(message.angular_rate)),
            covariance.of_pairs((deviations.velocity ** 2,) * 3, (rate,) * 3))

    def _imu(self, stamp_ns: int, orientation: Quaternion | None, force: Vector, rate: Vector,
             covariances: tuple[Matrix, Matrix]) -> values.Imu:
        options = self._options
        force_covariance, rate_covariance = covariances
        return values.imu(
            stamp_ns, options.frame_id, orientation, self._orientation_covariance,
            rate, _known(rate, rate_covariance), force, _known(force, force_covariance))


def _finite(numbers: tuple[float, ...]) -> bool:
    return all(map(math.isfinite, numbers))


def _numbers(vector: Vector) -> Vector:
    """Return the vector with NaN in place of infinity."""
    x, y, z = (value if math.isfinite(value) else math.nan for value in vector)
    return x, y, z


def _diagonal(stddev: float) -> Matrix:
    return covariance.of_vector((1.0,) * 3, stddev)


def _known(vector: Vector, matrix: Matrix) -> Matrix:
    return matrix if _finite(vector) else covariance.NOT_REPORTED
