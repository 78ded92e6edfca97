# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start the driver for a Titan-M.

    ros2 launch bahrs_driver titan_m.launch.py port:=/dev/ttyUSB0

Arguments are those of bahrs.launch.py. The sensor is a Titan-M even if the parameter file names
another; only the argument sensor overrides it.
"""

from bahrs_driver.node.launching import describe_driver
from launch import LaunchDescription


def generate_launch_description() -> LaunchDescription:
    """Return the driver node with the parameters of the device."""
    return describe_driver(__file__)
