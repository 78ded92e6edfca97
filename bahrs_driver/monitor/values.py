# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the messages of each topic say, in words and as numbers."""

from collections.abc import Callable
import math
from typing import Any, NamedTuple

from bahrs_driver.convert.covariance import UNKNOWN_VARIANCE
from diagnostic_msgs.msg import DiagnosticStatus


class Attitude(NamedTuple):
    """Roll to the right, pitch upward and yaw in degrees, as the published frames have them."""

    roll: float
    pitch: float
    yaw: float


def attitude(imu: Any) -> Attitude | None:
    """Return the attitude in an Imu message; None if it is not reported."""
    if imu.orientation_covariance[0] < 0:
        return None
    q = imu.orientation
    return Attitude(
        math.degrees(math.atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x ** 2 + q.y ** 2))),
        math.degrees(math.asin(max(-1.0, min(1.0, 2 * (q.w * q.y - q.z * q.x))))),
        math.degrees(math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y ** 2 + q.z ** 2))))


def vertical_force(imu: Any) -> float:
    """
    Return the specific force along z of the published world frame, in m/s^2; NaN if unknown.

    It holds the aircraft up: its mean is +9.8 where the world's z axis is up, -9.8 where down.
    """
    q, force = imu.orientation, imu.linear_acceleration
    if imu.orientation_covariance[0] < 0 or imu.linear_acceleration_covariance[0] < 0:
        return math.nan
    return float(2 * (q.x * q.z - q.w * q.y) * force.x + 2 * (q.y * q.z + q.w * q.x) * force.y
                 + (1 - 2 * (q.x ** 2 + q.y ** 2)) * force.z)


def _force_and_rate(imu: Any) -> str:
    return f'f {_xyz(imu.linear_acceleration, 2)}  ω {_xyz(imu.angular_velocity, 3)}'


def _xyz(vector: Any, digits: int) -> str:
    return ' '.join('-' if math.isnan(value) else f'{value:+.{digits}f}'
                    for value in (vector.x, vector.y, vector.z))


def _attitude(imu: Any) -> str:
    angles = attitude(imu)
    if angles is None:
        return 'no orientation'
    return f'roll {angles.roll:+.2f}° pitch {angles.pitch:+.2f}° yaw {angles.yaw:+.2f}°'


def _field(message: Any) -> str:
    field = message.magnetic_field
    return f'{field.x * 1e6:+.1f} {field.y * 1e6:+.1f} {field.z * 1e6:+.1f} µT'


def _integrity(notice: Any) -> str:
    troubled = [f'{status.name} {status.message}' for status in notice.status
                if status.level != DiagnosticStatus.OK]
    return ', '.join(troubled) or 'all signals safe'


def _heading(message: Any) -> str:
    return 'unavailable' if math.isnan(message.data) else f'{message.data:.1f}°'


def _velocity(message: Any) -> str:
    velocity = message.twist.twist.linear
    across = message.twist.covariance[0] < UNKNOWN_VARIANCE     # or only upward is measured
    return (f'x {velocity.x:+.2f} y {velocity.y:+.2f} ' if across else '') \
        + f'z {velocity.z:+.2f} m/s'


def _position(fix: Any) -> str:
    if fix.status.status < 0:
        return 'no fix'
    return f'{fix.latitude:+.7f}° {fix.longitude:+.7f}° {fix.altitude:.1f} m'


def _odometry(message: Any) -> str:
    position = message.pose.pose.position
    return f'x {position.x:+.1f} y {position.y:+.1f} z {position.z:+.1f} m'


def _device_time(reference: Any) -> str:
    time = reference.time_ref
    clock = 'GPS' if reference.source == 'gps' else 'device'
    return f'{clock} time {time.sec + time.nanosec * 1e-9:.3f} s'


FORMATS: dict[str, Callable[[Any], str]] = {
    'imu/data_raw': _force_and_rate,
    'imu/data': _attitude,
    'imu/mag': _field,
    'static_pressure': lambda message: f'{message.fluid_pressure / 100:.2f} hPa',
    'pressure_altitude': lambda message: f'{message.altitude:.1f} m',
    'altitude/pose': lambda message: f'z {message.pose.pose.position.z:+.1f} m',
    'velocity': _velocity,
    'differential_pressure': lambda message: f'{message.fluid_pressure:.1f} Pa',
    'temperature': lambda message: f'{message.temperature:.1f} °C',
    'fix': _position,
    'odometry': _odometry,
    'heading': _heading,
    'integrity': _integrity,
    'time_reference': _device_time,
    'sync_pulse': _device_time,
}
