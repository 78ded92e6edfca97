# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that subscribes until a signal comes."""

from collections.abc import Callable
import sys

from bahrs_driver.process.shutdown_event import ShutdownEvent
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


def run(name: str, subscribe: Callable[[Node], None]) -> None:
    """Make a node, let it subscribe, print a line, and run its callbacks until a signal comes."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(name)
    subscribe(node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    print('ready', flush=True)
    while not shutdown.is_set():
        executor.spin_once(0.1)
    rclpy.shutdown()
