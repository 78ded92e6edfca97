# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The floor of a start: a process that imports rclpy, makes a publisher and publishes at once."""

import sys
import time

import rclpy
from sensor_msgs.msg import Imu


def main() -> None:
    """Publish every millisecond until a signal comes, because the first subscriber may be late."""
    rclpy.init(args=sys.argv)
    publisher = rclpy.create_node('bare').create_publisher(Imu, 'imu/data_raw', 100)
    while rclpy.ok():
        publisher.publish(Imu())
        time.sleep(0.001)


if __name__ == '__main__':
    main()
