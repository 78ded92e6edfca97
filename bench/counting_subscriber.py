# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A process that subscribes to all topics of a BAHRS, and prints every second what came."""

from functools import partial
from typing import Any

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.ros_layout.message_objects import message_type
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
import subscriber

TOPICS: dict[str, Any] = {
    **{topic: message_type(kind) for topic, kind in DEVICES['bahrs'].topics().items()},
    '/diagnostics': DiagnosticArray}


def subscribe(node: Node) -> None:
    """Subscribe to serialized messages, and count them."""
    counts = dict.fromkeys(TOPICS, 0)

    def count(topic: str, _: bytes) -> None:
        counts[topic] += 1

    for topic, kind in TOPICS.items():
        node.create_subscription(kind, topic, partial(count, topic), 100, raw=True)
    node.create_timer(1.0, lambda: print(counts, flush=True))


if __name__ == '__main__':
    subscriber.run('counting', subscribe)
