# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The values of ROS messages, without ROS.

A class has the name and the fields of a message type, in the order of its definition; the package
`ros_layout` turns it into a serialized message. Stamps and times are in ns since the epoch of
their clock. Vectors are (x, y, z), quaternions (x, y, z, w), covariances row by row.
"""

from typing import NamedTuple

from bahrs_driver.convert import covariance
from bahrs_driver.convert.axes import NO_ROTATION, Quaternion
from bahrs_driver.convert.covariance import Matrix
from bahrs_driver.convert.utm import LatLon
from bahrs_driver.protocol.layout import Vector

_NAN = float('nan')
NO_VECTOR: Vector = (_NAN, _NAN, _NAN)
_ORIGIN: Vector = (0.0, 0.0, 0.0)
_NO_TURN = (0.0, 0.0, 0.0, 1.0)         # (x, y, z, w)
_Z = 2
_NO_FIX, _FIX, _GPS = -1, 0, 1          # NavSatStatus.STATUS_* and SERVICE_GPS
OK, WARN, ERROR, STALE = b'\0', b'\1', b'\2', b'\3'     # DiagnosticStatus.*
# NavSatFix.COVARIANCE_TYPE_*
_UNKNOWN_TYPE, _APPROXIMATED, _DIAGONAL_KNOWN = 0, 1, 2

XYZW = tuple[float, float, float, float]


class Imu(NamedTuple):
    """sensor_msgs/Imu: orientation, rad/s and m/s^2."""

    stamp_ns: int
    frame_id: str
    orientation: XYZW
    orientation_covariance: Matrix
    angular_velocity: Vector
    angular_velocity_covariance: Matrix
    linear_acceleration: Vector
    linear_acceleration_covariance: Matrix


class MagneticField(NamedTuple):
    """sensor_msgs/MagneticField: tesla."""

    stamp_ns: int
    frame_id: str
    magnetic_field: Vector
    magnetic_field_covariance: Matrix


class FluidPressure(NamedTuple):
    """sensor_msgs/FluidPressure: Pa."""

    stamp_ns: int
    frame_id: str
    fluid_pressure: float
    variance: float


class Temperature(NamedTuple):
    """sensor_msgs/Temperature: degrees Celsius."""

    stamp_ns: int
    frame_id: str
    temperature: float
    variance: float


class NavSatFix(NamedTuple):
    """sensor_msgs/NavSatFix: degrees, m above the ellipsoid, m^2."""

    stamp_ns: int
    frame_id: str
    status: int
    service: int
    latitude: float
    longitude: float
    altitude: float
    position_covariance: Matrix
    position_covariance_type: int


class PoseWithCovarianceStamped(NamedTuple):
    """geometry_msgs/PoseWithCovarianceStamped: m and rad."""

    stamp_ns: int
    frame_id: str
    position: Vector
    orientation: XYZW
    covariance: Matrix


class TwistWithCovarianceStamped(NamedTuple):
    """geometry_msgs/TwistWithCovarianceStamped: m/s and rad/s."""

    stamp_ns: int
    frame_id: str
    linear: Vector
    angular: Vector
    covariance: Matrix


class Odometry(NamedTuple):
    """nav_msgs/Odometry: the pose in the frame of the header, the twist in the child frame."""

    stamp_ns: int
    frame_id: str
    child_frame_id: str
    position: Vector
    orientation: XYZW
    pose_covariance: Matrix
    linear: Vector
    angular: Vector
    twist_covariance: Matrix


class TimeReference(NamedTuple):
    """sensor_msgs/TimeReference: the time of another clock beside that of the header, in ns."""

    stamp_ns: int
    frame_id: str
    time_ref_ns: int
    source: str


class Float64(NamedTuple):
    """std_msgs/Float64."""

    data: float


class Vector3Stamped(NamedTuple):
    """geometry_msgs/Vector3Stamped: roll, pitch and yaw in rad."""

    stamp_ns: int
    frame_id: str
    vector: Vector


class TransformStamped(NamedTuple):
    """geometry_msgs/TransformStamped: the pose of the child frame in the frame, in m."""

    stamp_ns: int
    frame_id: str
    child_frame_id: str
    translation: Vector
    rotation: XYZW


class TFMessage(NamedTuple):
    """tf2_msgs/TFMessage."""

    transforms: tuple[TransformStamped, ...]


class KeyValue(NamedTuple):
    """diagnostic_msgs/KeyValue."""

    key: str
    value: str


class DiagnosticStatus(NamedTuple):
    """diagnostic_msgs/DiagnosticStatus: the level is OK, WARN, ERROR or STALE."""

    level: bytes
    name: str
    message: str
    hardware_id: str
    values: tuple[KeyValue, ...] = ()


class DiagnosticArray(NamedTuple):
    """diagnostic_msgs/DiagnosticArray."""

    stamp_ns: int
    frame_id: str
    status: tuple[DiagnosticStatus, ...]


class MultiArrayDimension(NamedTuple):
    """std_msgs/MultiArrayDimension: sizes are in elements."""

    label: str
    size: int
    stride: int


class UInt8MultiArray(NamedTuple):
    """std_msgs/UInt8MultiArray, whose dimensions are those of its layout."""

    dim: tuple[MultiArrayDimension, ...]
    data_offset: int
    data: bytes


def imu(stamp_ns: int, frame_id: str, orientation: Quaternion | None,
        orientation_covariance: Matrix, rate: Vector, rate_covariance: Matrix, force: Vector,
        force_covariance: Matrix) -> Imu:
    """
    Return angular rate (rad/s), specific force (m/s^2) and orientation with their covariances.

    A component of NaN, and an orientation of None, is not reported.
    """
    if orientation is None:
        orientation, orientation_covariance = NO_ROTATION, covariance.NOT_REPORTED
    return Imu(stamp_ns, frame_id, xyzw(orientation), orientation_covariance,
               rate, rate_covariance, force, force_covariance)


def altitude_fix(stamp_ns: int, frame_id: str, altitude: float, stddev: float) -> NavSatFix:
    """Return an altitude in m without any horizontal position."""
    return NavSatFix(
        stamp_ns, frame_id, _NO_FIX, 0, _NAN, _NAN, altitude,
        covariance.known_diagonal(
            (covariance.UNKNOWN_VARIANCE, covariance.UNKNOWN_VARIANCE, stddev ** 2)),
        _DIAGONAL_KNOWN)


def position_fix(stamp_ns: int, frame_id: str, position: LatLon | None, altitude: float,
                 horizontal_stddev: float, vertical_stddev: float) -> NavSatFix:
    """Return a position in degrees and m above the ellipsoid; without one it is no fix."""
    if position is None:
        return NavSatFix(stamp_ns, frame_id, _NO_FIX, _GPS, _NAN, _NAN, _NAN, covariance.UNKNOWN,
                         _UNKNOWN_TYPE)
    known = horizontal_stddev or vertical_stddev
    return NavSatFix(
        stamp_ns, frame_id, _FIX, _GPS, position.latitude, position.longitude, altitude,
        covariance.known_diagonal(
            (horizontal_stddev ** 2, horizontal_stddev ** 2, vertical_stddev ** 2)),
        _APPROXIMATED if known else _UNKNOWN_TYPE)


def height_pose(stamp_ns: int, frame_id: str, z: float,
                stddev: float) -> PoseWithCovarianceStamped:
    """Return a pose of which only z, in m, is known."""
    return PoseWithCovarianceStamped(
        stamp_ns, frame_id, (0.0, 0.0, z), _NO_TURN, covariance.of_z_only(_Z, stddev))


def vertical_twist(stamp_ns: int, frame_id: str, z: float,
                   stddev: float) -> TwistWithCovarianceStamped:
    """Return a twist of which only the velocity along z, in m/s, is known."""
    return TwistWithCovarianceStamped(
        stamp_ns, frame_id, (0.0, 0.0, z), _ORIGIN, covariance.of_z_only(_Z, stddev))


def twist(stamp_ns: int, frame_id: str, velocity: Vector,
          stddev: float) -> TwistWithCovarianceStamped:
    """Return a twist of which the velocity, in m/s, is known and the rotation is not."""
    return TwistWithCovarianceStamped(
        stamp_ns, frame_id, velocity, _ORIGIN, covariance.of_pairs(
            (stddev ** 2,) * 3, (covariance.UNKNOWN_VARIANCE,) * 3))


def odometry(stamp_ns: int, frame_id: str, child_frame_id: str, position: Vector,
             orientation: Quaternion, pose_covariance: Matrix, velocity: Vector, rate: Vector,
             twist_covariance: Matrix) -> Odometry:
    """Return the pose of a body in the header's frame (m) and its twist in its own (m/s)."""
    return Odometry(stamp_ns, frame_id, child_frame_id, position, xyzw(orientation),
                    pose_covariance, velocity, rate, twist_covariance)


def xyzw(quaternion: Quaternion) -> XYZW:
    """Return the components in the order of ROS."""
    w, x, y, z = quaternion
    return x, y, z, w
