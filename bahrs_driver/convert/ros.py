# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Build ROS messages from plain numbers. No other module knows their fields."""

from bahrs_driver.convert import covariance
from bahrs_driver.convert.axes import NO_ROTATION, Quaternion
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.convert.utm import LatLon
from bahrs_driver.protocol.layout import Vector
from bahrs_driver.units import NS_PER_S, US_PER_S
from geometry_msgs.msg import (
    Point,
    PoseWithCovarianceStamped,
    Quaternion as QuaternionMessage,
    TwistWithCovarianceStamped,
    Vector3,
)
from nav_msgs.msg import Odometry
from sensor_msgs.msg import (
    FluidPressure, Imu, MagneticField, NavSatFix, NavSatStatus, Temperature, TimeReference,
)
from std_msgs.msg import Float64, Header

_NAN = float('nan')
NO_VECTOR: Vector = (_NAN, _NAN, _NAN)
_Z = 2


def nanoseconds(header: Header) -> int:
    """Return the stamp of a received header in ns; rclpy.time.Time raises for some stamps."""
    return int(header.stamp.sec * NS_PER_S + header.stamp.nanosec)


def header(stamp_ns: int, frame_id: str) -> Header:
    """Return a header; stamp_ns is in nanoseconds since the epoch."""
    message = Header(frame_id=frame_id)
    message.stamp.sec, message.stamp.nanosec = divmod(stamp_ns, NS_PER_S)
    return message


def imu(head: Header, orientation: Quaternion | None, orientation_covariance: Matrix,
        rate: Vector, rate_covariance: Matrix, force: Vector, force_covariance: Matrix) -> Imu:
    """
    Return angular rate (rad/s), specific force (m/s^2) and orientation with their covariances.

    A component of NaN, and an orientation of None, is not reported.
    """
    message = Imu(header=head)
    message.orientation = _quaternion(orientation or NO_ROTATION)
    message.orientation_covariance = (
        orientation_covariance if orientation else covariance.NOT_REPORTED)
    message.angular_velocity = _vector3(rate)
    message.angular_velocity_covariance = rate_covariance
    message.linear_acceleration = _vector3(force)
    message.linear_acceleration_covariance = force_covariance
    return message


def magnetic_field(head: Header, field: Vector, field_covariance: Matrix) -> MagneticField:
    """Return a magnetic field in tesla, its covariance in tesla squared."""
    return MagneticField(header=head, magnetic_field=_vector3(field),
                         magnetic_field_covariance=field_covariance)


def fluid_pressure(head: Header, pressure: float, stddev: float) -> FluidPressure:
    """Return a pressure in Pa."""
    return FluidPressure(header=head, fluid_pressure=pressure, variance=stddev ** 2)


def altitude_fix(head: Header, altitude: float, stddev: float) -> NavSatFix:
    """Return an altitude in m without any horizontal position."""
    message = NavSatFix(header=head, latitude=_NAN, longitude=_NAN, altitude=altitude)
    message.status = NavSatStatus(status=NavSatStatus.STATUS_NO_FIX)
    message.position_covariance = covariance.known_diagonal(
        (covariance.UNKNOWN_VARIANCE, covariance.UNKNOWN_VARIANCE, stddev ** 2))
    message.position_covariance_type = NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN
    return message


def position_fix(head: Header, position: LatLon | None, altitude: float, horizontal_stddev: float,
                 vertical_stddev: float) -> NavSatFix:
    """Return a position in degrees and m above the ellipsoid; without one it is no fix."""
    if position is None:
        message = NavSatFix(header=head, latitude=_NAN, longitude=_NAN, altitude=_NAN)
        message.status = NavSatStatus(status=NavSatStatus.STATUS_NO_FIX,
                                      service=NavSatStatus.SERVICE_GPS)
        return message
    message = NavSatFix(header=head, latitude=position.latitude, longitude=position.longitude,
                        altitude=altitude)
    message.status = NavSatStatus(status=NavSatStatus.STATUS_FIX,
                                  service=NavSatStatus.SERVICE_GPS)
    message.position_covariance = covariance.known_diagonal(
        (horizontal_stddev ** 2, horizontal_stddev ** 2, vertical_stddev ** 2))
    known = horizontal_stddev or vertical_stddev
    message.position_covariance_type = (
        NavSatFix.COVARIANCE_TYPE_APPROXIMATED if known else NavSatFix.COVARIANCE_TYPE_UNKNOWN)
    return message


def height_pose(head: Header, z: float, stddev: float) -> PoseWithCovarianceStamped:
    """Return a pose of which only z, in m, is known."""
    message = PoseWithCovarianceStamped(header=head)
    message.pose.pose.position.z = z
    message.pose.covariance = covariance.of_z_only(_Z, stddev)
    return message


def vertical_twist(head: Header, z: float, stddev: float) -> TwistWithCovarianceStamped:
    """Return a twist of which only the velocity along z, in m/s, is known."""
    message = TwistWithCovarianceStamped(header=head)
    message.twist.twist.linear.z = z
    message.twist.covariance = covariance.of_z_only(_Z, stddev)
    return message


def twist(head: Header, velocity: Vector, stddev: float) -> TwistWithCovarianceStamped:
    """Return a twist of which the velocity, in m/s, is known and the rotation is not."""
    message = TwistWithCovarianceStamped(header=head)
    message.twist.twist.linear = _vector3(velocity)
    message.twist.covariance = covariance.of_pairs(
        (stddev ** 2,) * 3, (covariance.UNKNOWN_VARIANCE,) * 3)
    return message


def odometry(head: Header, child_frame_id: str, position: Vector, orientation: Quaternion,
             pose_covariance: Matrix, velocity: Vector, rate: Vector,
             twist_covariance: Matrix) -> Odometry:
    """Return the pose of a body in the header's frame (m) and its twist in its own (m/s)."""
    message = Odometry(header=head, child_frame_id=child_frame_id)
    x, y, z = position
    message.pose.pose.position = Point(x=x, y=y, z=z)
    message.pose.pose.orientation = _quaternion(orientation)
    message.pose.covariance = pose_covariance
    message.twist.twist.linear = _vector3(velocity)
    message.twist.twist.angular = _vector3(rate)
    message.twist.covariance = twist_covariance
    return message


def temperature(head: Header, celsius: float, stddev: float) -> Temperature:
    """Return a temperature in degrees Celsius."""
    return Temperature(header=head, temperature=celsius, variance=stddev ** 2)


def time_reference(head: Header, reference_us: int, source: str) -> TimeReference:
    """Return another clock's time, in microseconds, beside the header's."""
    message = TimeReference(header=head, source=source)
    seconds, rest = divmod(reference_us, US_PER_S)
    message.time_ref.sec, message.time_ref.nanosec = seconds, 1000 * rest
    return message


def number(value: float) -> Float64:
    """Return a bare number."""
    return Float64(data=value)


def _vector3(vector: Vector) -> Vector3:
    x, y, z = vector
    return Vector3(x=x, y=y, z=z)


def _quaternion(quaternion: Quaternion) -> QuaternionMessage:
    w, x, y, z = quaternion
    return QuaternionMessage(w=w, x=x, y=y, z=z)
