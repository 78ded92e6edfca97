# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The floor of the driver: a process that publishes ready-made messages at the rates of a BAHRS.

It reads no port, decodes nothing and reuses one message object per topic.
"""

from collections.abc import Iterator
import sys
import time
from typing import Any

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.process.shutdown_event import ShutdownEvent
from bahrs_driver.ros_layout.message_objects import message_type
import rclpy
from rclpy.publisher import Publisher
from rclpy.signals import SignalHandlerOptions

SAMPLE_PERIOD = 0.005       # s
# Published every so many samples; topics that only publish changes are left out.
EVERY = {'imu/data_raw': 1, 'imu/data': 2, 'imu/mag': 2, 'static_pressure': 2,
         'pressure_altitude': 2, 'altitude/pose': 2, 'velocity': 2, 'attitude/rpy': 2,
         'heading': 2, 'time_reference': 20}


def main() -> None:
    """Publish until a signal comes; print a line when the publishers exist."""
    shutdown = ShutdownEvent()
    shutdown.install_signal_handlers()
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node('bare')
    types = {topic: message_type(kind) for topic, kind in DEVICES['bahrs'].topics().items()}
    publishers = [(every, node.create_publisher(types[topic], topic, 100), types[topic]())
                  for topic, every in EVERY.items()]
    print('ready', flush=True)
    for due in _samples(publishers):
        if shutdown.is_set():
            break
        time.sleep(max(0.0, due - time.monotonic()))
    rclpy.shutdown()


def _samples(publishers: list[tuple[int, Publisher, Any]]) -> Iterator[float]:
    """Publish what is due with each sample; yield when the next one is, on steady time."""
    due, number = time.monotonic(), 0
    while True:
        for every, publisher, message in publishers:
            if number % every == 0:
                if every == 1:          # for the measurement of latency
                    message.linear_acceleration.x = time.monotonic()
                publisher.publish(message)
        number += 1
        due += SAMPLE_PERIOD
        yield due


if __name__ == '__main__':
    main()
