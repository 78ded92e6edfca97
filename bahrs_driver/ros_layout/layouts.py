# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The layouts of all values that the converters return."""

from bahrs_driver.convert import values
from bahrs_driver.convert.outgoing import Values
from bahrs_driver.ros_layout.message_layout import MessageLayout
from bahrs_driver.ros_layout.rows import (
    array, data, HEADER, members, number, records, text, time,
)
from bahrs_driver.ros_layout.sequence_layout import SequenceLayout
from bahrs_driver.ros_layout.stamped_layout import StampedLayout

_POSE = 'm^2, m rad, rad^2'
_TWIST = '(m/s)^2, m rad/s^2, (rad/s)^2'

LAYOUTS: dict[type, MessageLayout] = {
    values.Imu: StampedLayout(
        'sensor_msgs/msg/Imu',
        members('orientation', 'xyzw'), array('orientation_covariance', 9, 'rad^2'),
        members('angular_velocity', 'xyz', 'rad/s'),
        array('angular_velocity_covariance', 9, '(rad/s)^2'),
        members('linear_acceleration', 'xyz', 'm/s^2'),
        array('linear_acceleration_covariance', 9, '(m/s^2)^2')),
    values.MagneticField: StampedLayout(
        'sensor_msgs/msg/MagneticField',
        members('magnetic_field', 'xyz', 'T'), array('magnetic_field_covariance', 9, 'T^2')),
    values.FluidPressure: StampedLayout(
        'sensor_msgs/msg/FluidPressure',
        number('fluid_pressure', 'd', 'Pa'), number('variance', 'd', 'Pa^2')),
    values.Temperature: StampedLayout(
        'sensor_msgs/msg/Temperature',
        number('temperature', 'd', 'degC'), number('variance', 'd', 'degC^2')),
    values.NavSatFix: StampedLayout(
        'sensor_msgs/msg/NavSatFix',
        number('status.status', 'b'), number('status.service', 'H'),
        number('latitude', 'd', 'deg'), number('longitude', 'd', 'deg'),
        number('altitude', 'd', 'm'),
        array('position_covariance', 9, 'm^2'), number('position_covariance_type', 'B')),
    values.PoseWithCovarianceStamped: StampedLayout(
        'geometry_msgs/msg/PoseWithCovarianceStamped',
        members('pose.pose.position', 'xyz', 'm'), members('pose.pose.orientation', 'xyzw'),
        array('pose.covariance', 36, _POSE)),
    values.TwistWithCovarianceStamped: StampedLayout(
        'geometry_msgs/msg/TwistWithCovarianceStamped',
        members('twist.twist.linear', 'xyz', 'm/s'),
        members('twist.twist.angular', 'xyz', 'rad/s'),
        array('twist.covariance', 36, _TWIST)),
    values.Odometry: MessageLayout(
        'nav_msgs/msg/Odometry', *HEADER, text('child_frame_id'),
        members('pose.pose.position', 'xyz', 'm'), members('pose.pose.orientation', 'xyzw'),
        array('pose.covariance', 36, _POSE),
        members('twist.twist.linear', 'xyz', 'm/s'),
        members('twist.twist.angular', 'xyz', 'rad/s'),
        array('twist.covariance', 36, _TWIST)),
    values.TimeReference: MessageLayout(
        'sensor_msgs/msg/TimeReference', *HEADER, time('time_ref'), text('source')),
    values.Vector3Stamped: StampedLayout(
        'geometry_msgs/msg/Vector3Stamped', members('vector', 'xyz', 'rad')),
    values.Float64: MessageLayout('std_msgs/msg/Float64', number('data', 'd')),
    values.TFMessage: SequenceLayout(
        'tf2_msgs/msg/TFMessage',
        records('transforms', 'geometry_msgs/msg/TransformStamped', *HEADER,
                text('child_frame_id'), members('transform.translation', 'xyz', 'm'),
                members('transform.rotation', 'xyzw'))),
    values.DiagnosticArray: SequenceLayout(
        'diagnostic_msgs/msg/DiagnosticArray', *HEADER,
        records('status', 'diagnostic_msgs/msg/DiagnosticStatus', number('level', 'c'),
                text('name'), text('message'), text('hardware_id'),
                records('values', 'diagnostic_msgs/msg/KeyValue', text('key'), text('value')))),
    values.UInt8MultiArray: SequenceLayout(
        'std_msgs/msg/UInt8MultiArray',
        records('layout.dim', 'std_msgs/msg/MultiArrayDimension',
                text('label'), number('size', 'I'), number('stride', 'I')),
        number('layout.data_offset', 'I'), data('data')),
}


def type_name(kind: type) -> str:
    """Return the name of the message type of a class of values, such as sensor_msgs/msg/Imu."""
    return LAYOUTS[kind].name


def serialize(message: Values) -> bytes:
    """Return the serialized message of values; struct.error if a number does not fit."""
    return LAYOUTS[type(message)].serialize(message)
