# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start the driver for a BAHRS.

    ros2 launch bahrs_driver bahrs.launch.py port:=/dev/ttyUSB0
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the driver node with its parameters from a file, and the port from an argument."""
    parameters = PathJoinSubstitution([FindPackageShare('bahrs_driver'), 'config', 'bahrs.yaml'])
    return LaunchDescription([
        DeclareLaunchArgument('port', default_value='/dev/ttyUSB0',
                              description='serial port: a path, or a pyserial URL'),
        DeclareLaunchArgument('namespace', default_value='',
                              description='namespace of the node and its topics'),
        DeclareLaunchArgument('params_file', default_value=parameters,
                              description='file of parameters'),
        Node(
            package='bahrs_driver',
            executable='driver_node',
            name='bahrs_driver',
            namespace=LaunchConfiguration('namespace'),
            parameters=[LaunchConfiguration('params_file'),
                        {'port': LaunchConfiguration('port')}],
            output='screen',
        ),
    ])
