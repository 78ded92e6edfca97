# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find messages that are complete: none of their numbers is NaN.

NaN means that a component is not reported. A filter with a state, such as most orientation
filters, never recovers from a NaN, so its user may have incomplete messages withheld. NavSatFix is
not checked: the altitude of `pressure_altitude` has no latitude and longitude, and the status of a
`fix` shows whether it has a position.
"""

from collections.abc import Callable, Iterable, Iterator
import math

from geometry_msgs.msg import (
    Point, Pose, PoseWithCovarianceStamped, Quaternion, Twist, TwistWithCovarianceStamped, Vector3,
)
from nav_msgs.msg import Odometry
from sensor_msgs.msg import FluidPressure, Imu, MagneticField, Temperature
from std_msgs.msg import Float64

Numbers = tuple[float, ...]


def _vector(vector: Vector3 | Point | Quaternion) -> Numbers:
    return vector.x, vector.y, vector.z


def _pose(pose: Pose) -> Numbers:
    return *_vector(pose.position), pose.orientation.w, *_vector(pose.orientation)


def _twist(twist: Twist) -> Numbers:
    return *_vector(twist.linear), *_vector(twist.angular)


NUMBERS: dict[type, Callable[..., Numbers]] = {
    Imu: lambda message: (message.orientation.w, *_vector(message.orientation),
                          *_vector(message.angular_velocity),
                          *_vector(message.linear_acceleration)),
    MagneticField: lambda message: _vector(message.magnetic_field),
    FluidPressure: lambda message: (message.fluid_pressure,),
    Temperature: lambda message: (message.temperature,),
    Float64: lambda message: (message.data,),
    PoseWithCovarianceStamped: lambda message: _pose(message.pose.pose),
    TwistWithCovarianceStamped: lambda message: _twist(message.twist.twist),
    Odometry: lambda message: (*_pose(message.pose.pose), *_twist(message.twist.twist)),
}


def complete(message: object) -> bool:
    """Return whether no number of a message is NaN."""
    numbers = NUMBERS.get(type(message))
    return numbers is None or not any(map(math.isnan, numbers(message)))


def without_incomplete(outgoing: Iterable[tuple[str, object]]) -> Iterator[tuple[str, object]]:
    """Yield the topics and messages that are complete."""
    return (pair for pair in outgoing if complete(pair[1]))
