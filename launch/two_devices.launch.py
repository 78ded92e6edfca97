# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start a driver for a BAHRS and one for a Titan-M, each in a namespace and with frames of its own.

    ros2 launch bahrs_driver two_devices.launch.py bahrs_port:=/dev/ttyUSB0 \
        titan_m_port:=/dev/ttyUSB1

Copy it and change it: names, namespaces, and the position of each device in base_link. Topics are
/bahrs/imu/data, /titan_m/imu/data and so on.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return both drivers."""
    return LaunchDescription([
        DeclareLaunchArgument('bahrs_port', description='serial port of the BAHRS'),
        DeclareLaunchArgument('titan_m_port', description='serial port of the Titan-M'),
        _driver('bahrs', {
            'port': LaunchConfiguration('bahrs_port'), 'namespace': 'bahrs',
            'frame_id': 'bahrs_link', 'x': '0.1'}),
        _driver('titan_m', {
            'port': LaunchConfiguration('titan_m_port'), 'namespace': 'titan_m',
            'frame_id': 'titan_m_link', 'x': '-0.1'}),
    ])


def _driver(device: str, arguments: dict[str, str | LaunchConfiguration]
            ) -> IncludeLaunchDescription:
    """Return an include; arguments of one driver do not reach the other."""
    share = FindPackageShare('bahrs_driver')
    return IncludeLaunchDescription(
        PathJoinSubstitution([share, 'launch', f'{device}.launch.py']),
        launch_arguments=arguments.items())
