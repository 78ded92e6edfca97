# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that prints when the first message after a pause came, on steady time in s."""

import time

from rclpy.node import Node
from sensor_msgs.msg import Imu
import subscriber

PAUSE = 0.5             # s


def subscribe(node: Node) -> None:
    """Subscribe to imu/data_raw."""
    latest = 0.0

    def show(_: bytes) -> None:
        nonlocal latest
        now = time.monotonic()
        if now - latest > PAUSE:
            print(now, flush=True)
        latest = now

    node.create_subscription(Imu, 'imu/data_raw', show, 100, raw=True)


if __name__ == '__main__':
    subscriber.run('first_message', subscribe)
