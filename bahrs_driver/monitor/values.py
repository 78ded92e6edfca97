# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Format the messages of each topic.

No function raises an error, whatever the message: numbers may be NaN, infinite or huge, and lists
empty or very long.
"""

from collections.abc import Callable
from itertools import islice
import math
from typing import NamedTuple

from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TwistWithCovarianceStamped, Vector3, Vector3Stamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, NavSatFix, TimeReference
from std_msgs.msg import Float64

EXPONENT_FROM = 1e7         # numbers are written with an exponent
MIN_NORM, MAX_NORM = 0.9, 1.1           # of a quaternion that is an orientation
MAX_UNSAFE = 32             # signals listed in a text
_MAX_KNOWN_VARIANCE = 0.99 * UNKNOWN_VARIANCE


class Attitude(NamedTuple):
    """Roll, pitch and yaw of the published frames in degrees."""

    roll: float
    pitch: float
    yaw: float          # NaN if it is not known


def number_text(value: float, spec: str = '.1f', unit: str = '') -> str:
    """Return a number with its unit; a dash if it is not finite."""
    if not math.isfinite(value):
        return '-'
    if abs(value) >= EXPONENT_FROM:
        spec = f"{'+' if spec.startswith('+') else ''}.3g"
    return format(value, spec) + unit


def attitude(imu: Imu) -> Attitude | None:
    """Return the attitude in an Imu message; None if it is not reported."""
    q, variances = imu.orientation, imu.orientation_covariance
    norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z
    if variances[0] < 0 or not MIN_NORM < norm < MAX_NORM:
        return None
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    return Attitude(
        math.degrees(math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y))),
        math.degrees(math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.z * q.x))))),
        math.degrees(yaw) if variances[8] < _MAX_KNOWN_VARIANCE else math.nan)


def attitude_text(angles: Attitude | None) -> str:
    """Return an attitude as text."""
    if angles is None:
        return 'no orientation'
    return ' '.join(f'{name} {number_text(value, "+.2f", "°")}'
                    for name, value in angles._asdict().items())


def vertical_force(imu: Imu) -> float:
    """
    Return the specific force along z of the published world frame, in m/s^2; NaN if unknown.

    On average it balances gravity: +9.8 if the z axis points up, -9.8 if down.
    """
    q, force = imu.orientation, imu.linear_acceleration
    if imu.orientation_covariance[0] < 0 or imu.linear_acceleration_covariance[0] < 0:
        return math.nan
    return float(2 * (q.x * q.z - q.w * q.y) * force.x + 2 * (q.y * q.z + q.w * q.x) * force.y
                 + (1 - 2 * (q.x * q.x + q.y * q.y)) * force.z)


def _force_and_rate(imu: Imu) -> str:
    return f'f {_xyz(imu.linear_acceleration, 2)}  ω {_xyz(imu.angular_velocity, 3)}'


def _xyz(vector: Vector3, digits: int, factor: float = 1.0) -> str:
    return ' '.join(number_text(value * factor, f'+.{digits}f')
                    for value in (vector.x, vector.y, vector.z))


def _integrity(notice: DiagnosticArray) -> str:
    unsafe = (f'{status.name} {status.message}' for status in notice.status
              if status.level != DiagnosticStatus.OK)
    return ', '.join(islice(unsafe, MAX_UNSAFE)) or 'all signals safe'


def _heading(message: Float64) -> str:
    return 'unavailable' if math.isnan(message.data) else number_text(message.data, '.1f', '°')


def _angles(message: Vector3Stamped) -> str:
    angles = message.vector
    return ' '.join(f'{name} {number_text(math.degrees(angle), "+.2f", "°")}' for name, angle in (
        ('roll', angles.x), ('pitch', angles.y), ('yaw', angles.z)))


def _velocity(message: TwistWithCovarianceStamped) -> str:
    velocity = message.twist.twist.linear
    has_xy = message.twist.covariance[0] < UNKNOWN_VARIANCE     # else only z is measured
    return ' '.join(f'{axis} {number_text(getattr(velocity, axis), "+.2f")}'
                    for axis in ('xyz' if has_xy else 'z')) + ' m/s'


def _position(fix: NavSatFix) -> str:
    if fix.status.status < 0:
        return 'no fix'
    return ' '.join((
        number_text(fix.latitude, '+.7f', '°'), number_text(fix.longitude, '+.7f', '°'),
        number_text(fix.altitude, '.1f', ' m')))


def _odometry(message: Odometry) -> str:
    position = message.pose.pose.position
    return ' '.join(f'{axis} {number_text(getattr(position, axis), "+.1f")}'
                    for axis in 'xyz') + ' m'


def _device_time(reference: TimeReference) -> str:
    time = reference.time_ref
    clock = 'GPS' if reference.source == 'gps' else 'device'
    return f'{clock} time {time.sec + time.nanosec * 1e-9:.3f} s'


FORMATS: dict[str, Callable[..., str]] = {
    'imu/data_raw': _force_and_rate,
    'imu/data': lambda message: attitude_text(attitude(message)),
    'imu/mag': lambda message: f'{_xyz(message.magnetic_field, 1, 1e6)} µT',
    'static_pressure': lambda message: number_text(message.fluid_pressure / 100, '.2f', ' hPa'),
    'pressure_altitude': lambda message: number_text(message.altitude, '.1f', ' m'),
    'altitude/pose': lambda message: 'z ' + number_text(
        message.pose.pose.position.z, '+.1f', ' m'),
    'velocity': _velocity,
    'differential_pressure': lambda message: number_text(message.fluid_pressure, '.1f', ' Pa'),
    'temperature': lambda message: number_text(message.temperature, '.1f', ' °C'),
    'fix': _position,
    'odometry': _odometry,
    'attitude/rpy': _angles,
    'heading': _heading,
    'integrity': _integrity,
    'time_reference': _device_time,
    'sync_pulse': _device_time,
}
