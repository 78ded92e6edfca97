# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The layouts of all values that the converters return."""

from bahrs_driver.convert import values
from bahrs_driver.ros_layout.message_layout import (
    array, HEADER, members, MessageLayout, number, text, time,
)

LAYOUTS: dict[type, MessageLayout] = {
    values.Imu: MessageLayout(
        'sensor_msgs/msg/Imu', *HEADER,
        members('orientation', 'xyzw'), array('orientation_covariance', 9),
        members('angular_velocity', 'xyz'), array('angular_velocity_covariance', 9),
        members('linear_acceleration', 'xyz'), array('linear_acceleration_covariance', 9)),
    values.MagneticField: MessageLayout(
        'sensor_msgs/msg/MagneticField', *HEADER,
        members('magnetic_field', 'xyz'), array('magnetic_field_covariance', 9)),
    values.FluidPressure: MessageLayout(
        'sensor_msgs/msg/FluidPressure', *HEADER,
        number('fluid_pressure', 'd'), number('variance', 'd')),
    values.Temperature: MessageLayout(
        'sensor_msgs/msg/Temperature', *HEADER,
        number('temperature', 'd'), number('variance', 'd')),
    values.NavSatFix: MessageLayout(
        'sensor_msgs/msg/NavSatFix', *HEADER,
        number('status.status', 'b'), number('status.service', 'H'),
        number('latitude', 'd'), number('longitude', 'd'), number('altitude', 'd'),
        array('position_covariance', 9), number('position_covariance_type', 'B')),
    values.PoseWithCovarianceStamped: MessageLayout(
        'geometry_msgs/msg/PoseWithCovarianceStamped', *HEADER,
        members('pose.pose.position', 'xyz'), members('pose.pose.orientation', 'xyzw'),
        array('pose.covariance', 36)),
    values.TwistWithCovarianceStamped: MessageLayout(
        'geometry_msgs/msg/TwistWithCovarianceStamped', *HEADER,
        members('twist.twist.linear', 'xyz'), members('twist.twist.angular', 'xyz'),
        array('twist.covariance', 36)),
    values.Odometry: MessageLayout(
        'nav_msgs/msg/Odometry', *HEADER, text('child_frame_id'),
        members('pose.pose.position', 'xyz'), members('pose.pose.orientation', 'xyzw'),
        array('pose.covariance', 36),
        members('twist.twist.linear', 'xyz'), members('twist.twist.angular', 'xyz'),
        array('twist.covariance', 36)),
    values.TimeReference: MessageLayout(
        'sensor_msgs/msg/TimeReference', *HEADER, time('time_ref'), text('source')),
    values.Float64: MessageLayout('std_msgs/msg/Float64', number('data', 'd')),
}
