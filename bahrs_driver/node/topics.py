# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The topics of a device, and the publishers of a node.

Values are published as serialized messages, and only on topics that have a subscriber: refresh()
finds out which ones those are. Latched topics are published in any case, for late subscribers. In
the first seconds of the node all topics are: a subscriber that was started before the node, and is
discovered meanwhile, finds from the sequence number of its first message how many it has missed.
"""

from collections.abc import Callable, Container, Iterable
import threading
import time

from bahrs_driver.convert import raw
from bahrs_driver.convert.outgoing import Values
from bahrs_driver.convert.transforms import TF
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.diagnostics.publishing_task import PublishingCounters
from bahrs_driver.node.latched_publisher import create_latched, LatchedPublisher
from bahrs_driver.node.subscriber_gate import SubscriberGate, Write
from bahrs_driver.node.transforms import Transforms
from bahrs_driver.ros_layout.message_objects import message_type
from bahrs_driver.ros_layout.serializer import Serializer
from bahrs_driver.units import BITS_PER_BYTE
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import UInt8MultiArray

LEAST_QUEUE_DEPTH = 100
QUEUE_SPAN = 5.0                # s of a full line for which a subscriber may pause
FRAME_SIZE = 28                 # bytes of a sample, the frame that can come most often
DISCOVERY_TIME = 5.0            # s in which subscribers that were started first are discovered


def queue_depth(baud_rate: int) -> int:
    """Return how many messages a publisher keeps for a reliable subscriber that pauses."""
    return max(LEAST_QUEUE_DEPTH, round(QUEUE_SPAN * baud_rate / BITS_PER_BYTE / FRAME_SIZE))


class Topics:
    """Publishes the values of a device, and counts them by topic."""

    def __init__(self, node: Node, spec: AnyDevice, settings: CommonSettings,
                 select: Callable[[Container[str]], None]) -> None:
        """Create the publishers; select is called with the topics in use when they change."""
        self._node = node
        self._gate = SubscriberGate(settings.startup.wait_for_subscribers)
        self._queue_depth = queue_depth(settings.baud_rate)
        types = {topic: message_type(kind) for topic, kind in spec.topics().items()}
        self._latched = {topic: create_latched(node, kind, topic, self.create_publisher)
                         for topic, kind in types.items() if topic in spec.latched()}
        self._data: dict[str, LatchedPublisher | Publisher] = {
            topic: self._latched.get(topic) or self.create_publisher(kind, topic)
            for topic, kind in types.items()}
        transforms = Transforms(settings, self.create_publisher)
        if transforms.attitude:
            self._data[TF] = transforms.attitude
        self._raw = self.create_publisher(UInt8MultiArray, raw.TOPIC) \
            if settings.publish.raw else None
        self._select = select
        serializer = Serializer()
        self.serialize = serializer.serialize
        self.warnings = [*serializer.warnings(), *transforms.warnings]
        self._in_use = frozenset(self._data)
        self._refreshing = threading.Lock()
        self._created_at = time.monotonic()
        self.raw = self._raw            # None if it is not in use
        self.counters = PublishingCounters(dict.fromkeys(self._data, 0))
        self.refresh()

    def create_publisher(self, kind: type, topic: str,
                         profile: QoSProfile | None = None) -> Publisher:
        """Create a publisher whose quality of service the user can override."""
        return self._node.create_publisher(
            kind, topic, profile or QoSProfile(depth=self._queue_depth),
            event_callbacks=self._gate.callbacks(),
            qos_overriding_options=QoSOverridingOptions.with_default_policies())

    def wait_for_subscribers(self, write_info: Write, write_warning: Write) -> None:
        """Wait until each topic has a subscriber if the settings say so."""
        raw_data = {raw.TOPIC: self._raw} if self._raw else {}
        self._gate.wait({**self._data, **raw_data}, write_info, write_warning)
        self.refresh()

    def stop_waiting(self) -> None:
        """End wait_for_subscribers()."""
        self._gate.open()

    def refresh(self) -> None:
        """Find out which topics have subscribers; call it ten times a second."""
        with self._refreshing:          # the reading thread calls it once, too
            self._refresh()

    def _refresh(self) -> None:
        subscribed = {topic for topic, publisher in self._data.items()
                      if publisher.get_subscription_count()}
        self.counters.in_use = subscribed
        if time.monotonic() - self._created_at < DISCOVERY_TIME:
            return
        self.raw = self._raw if self._raw and self._raw.get_subscription_count() else None
        in_use = frozenset(subscribed.union(self._latched))
        if in_use != self._in_use:
            self._in_use = in_use
            self._select(in_use)

    def publish(self, outgoing: Iterable[tuple[str, Values]]) -> None:
        """Publish values on their topics, if they are in use."""
        in_use, counts = self._in_use, self.counters.messages
        for topic, values in outgoing:
            if topic in in_use:
                self._data[topic].publish(self.serialize(values))
                counts[topic] += 1

    def flush(self) -> None:
        """Publish latched messages that wait for an acknowledgement, if possible."""
        for publisher in self._latched.values():
            publisher.flush()

    @property
    def has_slow_subscribers(self) -> bool:
        """Whether supervise() may have something to do."""
        return any(publisher.has_backlog for publisher in self._latched.values())

    def supervise(self) -> None:
        """
        Begin or end the backlog for slow subscribers of latched topics.

        Only the executor's thread may call it.
        """
        for publisher in self._latched.values():
            publisher.supervise()
