# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a device, and the publishers of a node."""

from collections.abc import Iterable

from bahrs_driver.convert import raw
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.node.latched_publisher import create_latched
from bahrs_driver.node.subscriber_gate import SubscriberGate, Write
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import UInt8MultiArray

QUEUE_DEPTH = 100               # half a second of the fastest topic


class Topics:
    """Publishes the messages of a device, and counts them by topic."""

    def __init__(self, node: Node, spec: AnyDevice, settings: CommonSettings) -> None:
        self._node = node
        self._gate = SubscriberGate(settings.startup.wait_for_subscribers)
        types = spec.topics()
        self._latched = {topic: create_latched(node, kind, topic, self.create_publisher)
                         for topic, kind in types.items() if topic in spec.latched()}
        self._data = {topic: self._latched.get(topic) or self.create_publisher(kind, topic)
                      for topic, kind in types.items()}
        self.raw = self.create_publisher(UInt8MultiArray, raw.TOPIC) \
            if settings.publish.raw else None
        self.counts = dict.fromkeys(types, 0)

    def create_publisher(self, kind: type, topic: str,
                         profile: QoSProfile | None = None) -> Publisher:
        """Create a publisher whose quality of service the user can override."""
        return self._node.create_publisher(
            kind, topic, profile or QoSProfile(depth=QUEUE_DEPTH),
            event_callbacks=self._gate.callbacks(),
            qos_overriding_options=QoSOverridingOptions.with_default_policies())

    def wait_for_subscribers(self, write_info: Write, write_warning: Write) -> None:
        """Wait until each topic has a subscriber if the settings say so."""
        raw_data = {raw.TOPIC: self.raw} if self.raw else {}
        self._gate.wait({**self._data, **raw_data}, write_info, write_warning)

    def stop_waiting(self) -> None:
        """End wait_for_subscribers()."""
        self._gate.open()

    def publish(self, outgoing: Iterable[tuple[str, object]]) -> None:
        """Publish messages on their topics."""
        for topic, message in outgoing:
            self._data[topic].publish(message)
            self.counts[topic] += 1

    def flush(self) -> None:
        """Publish latched messages that wait for an acknowledgement, if possible."""
        for publisher in self._latched.values():
            publisher.flush()

    def supervise(self) -> None:
        """Begin or end the backlog for slow subscribers of latched topics."""
        for publisher in self._latched.values():
            publisher.supervise()
