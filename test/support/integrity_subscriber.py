# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process of its own that prints each state it gets on the topic `integrity`."""

import sys

from diagnostic_msgs.msg import DiagnosticArray
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import Imu

ECHO_DEPTH = 5          # of ros2 topic echo


def show(notice: DiagnosticArray) -> None:
    """Print the state of the navigation signals, a letter for each."""
    stamp = notice.header.stamp
    letters = ''.join(status.message[0] for status in notice.status[-5:])
    print(letters, stamp.sec * 10**9 + stamp.nanosec, flush=True)


def main(once: bool) -> None:
    """Listen as `ros2 topic echo --once` does, or to all, and to what fills the queues."""
    rclpy.init()
    node = rclpy.create_node('subscriber')
    received: list[DiagnosticArray] = []
    node.create_subscription(
        DiagnosticArray, 'integrity', received.append if once else show,
        QoSProfile(depth=ECHO_DEPTH if once else 100,
                   durability=DurabilityPolicy.TRANSIENT_LOCAL))
    if not once:
        node.create_subscription(Imu, 'imu/data_raw', lambda message: None, 10)
    try:
        while not received:
            rclpy.spin_once(node)
    except (ExternalShutdownException, KeyboardInterrupt):
        return
    show(received[0])
    rclpy.shutdown()


if __name__ == '__main__':
    main('--once' in sys.argv)
