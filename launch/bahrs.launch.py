# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start the driver for a BAHRS.

    ros2 launch bahrs_driver bahrs.launch.py port:=/dev/ttyUSB0
    ros2 launch bahrs_driver bahrs.launch.py params_file:=my.yaml name:=front namespace:=left
    ros2 launch bahrs_driver bahrs.launch.py x:=0.1 pitch:=-0.05 rviz:=true publish_tf:=true

An argument overrides the parameter file, which overrides the defaults. --show-args lists all.
"""

from bahrs_driver.node.launching import describe_driver
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the driver node with the parameters of the device."""
    return describe_driver(__file__)
