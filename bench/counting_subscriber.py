# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that subscribes to all topics of a BAHRS, and counts serialised messages."""

import sys
import time

from bahrs_driver.convert.values import DiagnosticArray
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.process.shutdown_event import ShutdownEvent
from bahrs_driver.ros_layout.message_objects import message_type
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

TOPICS = {**DEVICES['bahrs'].topics(), '/diagnostics': DiagnosticArray}


def main() -> None:
    """Subscribe until a signal comes; print the counts every second."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('counting')
    counts = dict.fromkeys(TOPICS, 0)

    def count(topic: str) -> None:
        counts[topic] += 1

    for topic, kind in TOPICS.items():
        node.create_subscription(
            message_type(kind), topic, lambda _, topic=topic: count(topic), 100, raw=True)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    shown = 0.0
    while not shutdown.is_set():
        executor.spin_once(0.1)
        if time.monotonic() - shown > 1.0:
            shown = time.monotonic()
            print(counts, flush=True)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
