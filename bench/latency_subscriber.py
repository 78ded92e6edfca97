# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that prints force x of each message of imu/data_raw, and when its callback ran."""

import sys
import time

from bahrs_driver.process.shutdown_event import ShutdownEvent
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import Imu


def main() -> None:
    """Subscribe until a signal comes, then print."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('latency')
    received: list[tuple[float, float]] = []
    node.create_subscription(
        Imu, 'imu/data_raw',
        lambda message: received.append((message.linear_acceleration.x, time.monotonic())), 100)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    print('ready', flush=True)
    while not shutdown.is_set():
        executor.spin_once(0.1)
    rclpy.shutdown()
    for value, at in received:
        print(value, at)


if __name__ == '__main__':
    main()
