# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start the driver for a Titan-M.

    ros2 launch bahrs_driver titan_m.launch.py port:=/dev/ttyUSB0

It is the launch file of the BAHRS with other parameters; port and namespace go through to it.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the driver node with the parameters of a Titan-M."""
    share = FindPackageShare('bahrs_driver')
    driver = PythonLaunchDescriptionSource(
        PathJoinSubstitution([share, 'launch', 'bahrs.launch.py']))
    return LaunchDescription([
        DeclareLaunchArgument(
            'params_file',
            default_value=PathJoinSubstitution([share, 'config', 'titan_m.yaml']),
            description='file of parameters'),
        IncludeLaunchDescription(driver, launch_arguments={
            'params_file': LaunchConfiguration('params_file')}.items()),
    ])
