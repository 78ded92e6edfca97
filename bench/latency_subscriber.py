# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that prints force x of each message of imu/data_raw, and when its callback ran."""

import time

from rclpy.node import Node
from sensor_msgs.msg import Imu
import subscriber


def main() -> None:
    """Subscribe until a signal comes, then print."""
    received: list[tuple[float, float]] = []

    def add(message: Imu) -> None:
        received.append((message.linear_acceleration.x, time.monotonic()))

    def subscribe(node: Node) -> None:
        node.create_subscription(Imu, 'imu/data_raw', add, 100)

    subscriber.run('latency', subscribe)
    for value, at in received:
        print(value, at)


if __name__ == '__main__':
    main()
