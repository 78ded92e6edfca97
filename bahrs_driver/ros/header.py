# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Headers of received messages."""

from bahrs_driver.units import NS_PER_S
from std_msgs.msg import Header


def nanoseconds(header: Header) -> int:
    """Return the stamp of a header in ns; rclpy.time.Time raises for some stamps."""
    return int(header.stamp.sec * NS_PER_S + header.stamp.nanosec)
