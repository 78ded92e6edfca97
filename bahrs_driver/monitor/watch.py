# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Watch the topics of a driver.

Messages are counted and kept as bytes. Only those that are shown are deserialized, so that the
monitor needs little time of the host. Any node may publish on these topics, so a message may be
malformed.
"""

from functools import partial
import math
import time
from typing import Any

from bahrs_driver.devices.driver_graph import NodeSearch
from bahrs_driver.devices.registry import all_formats, all_latched, all_topics
from bahrs_driver.monitor.health import DriverHealth
from bahrs_driver.monitor.topic_stats import TopicStats
from bahrs_driver.monitor.values import Attitude, attitude, attitude_text, FORMATS, vertical_force
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import full_name, NodeChoice, ROOT, Selection, split_name
from bahrs_driver.ros_layout.message_objects import message_type
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription

MAX_WAIT = 0.05             # s that one wait for a message takes
DATA_TIMEOUT = 1.5          # s without data, after which it has stopped
DRIVER_TIMEOUT = 3.5        # s without diagnostics, after which the driver is gone
DIAGNOSTICS = '/diagnostics'
MAX_FORCE = 1000.0          # m/s^2; a larger force is an error
LOW_PASS = 0.1              # weight of a new force

# An observer must not block a publisher, and must receive from best-effort publishers, too.
_QOS = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED_QOS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Watch:
    """Subscribes to the topics of one driver, and to all diagnostics to find it."""

    def __init__(self, node: Node, selection: Selection = Selection()) -> None:
        self._topics = {topic: message_type(kind) for topic, kind in all_topics().items()}
        self._latched = all_latched()
        self._formats = {**all_formats(), **FORMATS}
        self.stats = {topic: TopicStats() for topic in self._topics}
        self.choice = NodeChoice(selection)
        self.health = DriverHealth(self.choice)
        self.namespace = ''
        self._node = node
        self._search = NodeSearch(self.choice)
        self._subscriptions: list[Subscription] = []
        self._published: set[str] = set()         # topics that some node publishes
        self._data_at = -math.inf
        self._vertical_force = 0.0          # m/s^2, low-passed, along the world's z axis
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        self._subscribe_in(selection.namespace or ROOT)
        node.create_subscription(
            DiagnosticArray, DIAGNOSTICS, self._update_health, _QOS, raw=True)

    def spin(self, seconds: float) -> None:
        """Receive messages for a time in seconds."""
        self._published = {topic for topic in self._topics if self._node.count_publishers(
            full_name(topic, self.namespace))}
        self._search.update(self._node, time.monotonic())
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            # Always the same timeout: if it changes, rclpy begins with the first topic again, and
            # on a busy host never serves the last ones.
            self._executor.spin_once(timeout_sec=MAX_WAIT)
            if self.choice.chosen:
                self._subscribe_in(split_name(self.choice.chosen)[1])
        self._observe_gravity()

    @property
    def driver(self) -> str:
        """Fully qualified name of the driver, in printable form; empty if it is not known."""
        return printable(self.choice.chosen)

    @property
    def driver_seen(self) -> bool:
        """Whether any driver was seen."""
        return bool(self.health.tasks) or any(stats.count for stats in self.stats.values())

    @property
    def data_received(self) -> bool:
        """Whether any sample was received."""
        return self._data_at > -math.inf

    @property
    def data_age(self) -> float:
        """Seconds since the latest sample; infinite if there was none."""
        return time.monotonic() - self._data_at

    @property
    def z_down(self) -> bool:
        """Whether the driver publishes the device's own axes, with z downward."""
        return self._vertical_force < 0

    @property
    def has_topics(self) -> bool:
        """Whether any topic of the driver is or was published."""
        return any(self.is_published(topic) for topic in self._topics)

    def message(self, topic: str) -> Any:
        """Return the latest message of a topic; None if there is none, or it is malformed."""
        data = self.stats[topic].data if topic in self.stats else b''
        return _deserialize(data, self._topics[topic]) if data else None

    def text(self, topic: str) -> str:
        """Return the latest message of a topic as text; empty if there was none."""
        message = self.message(topic)
        if message is None:
            return 'malformed message' if self.stats[topic].data else ''
        if topic == 'imu/data':
            return attitude_text(self._pitch_up(attitude(message)))
        return printable(self._formats.get(topic, str)(message))

    def recent_message(self, topic: str) -> Any:
        """Return the latest message of a topic; None if it is older than DATA_TIMEOUT."""
        stats = self.stats.get(topic)
        return self.message(topic) if stats and stats.age < DATA_TIMEOUT else None

    def is_published(self, topic: str) -> bool:
        """Return whether a topic is or was published."""
        return bool(self.stats[topic].count) or topic in self._published

    def attitude(self) -> Attitude | None:
        """Return the latest attitude, pitch positive upward; None if it is old or unknown."""
        imu = self.recent_message('imu/data')
        return None if imu is None else self._pitch_up(attitude(imu))

    def _observe_gravity(self) -> None:
        """Update the force that shows whether the published z axis points up or down."""
        imu = self.message('imu/data')
        force = math.nan if imu is None else vertical_force(imu)
        if abs(force) < MAX_FORCE:
            self._vertical_force += LOW_PASS * (force - self._vertical_force)

    def _pitch_up(self, angles: Attitude | None) -> Attitude | None:
        """Convert an attitude to positive pitch upward, whichever axes are published."""
        if angles and not self.z_down:
            return angles._replace(pitch=-angles.pitch)
        return angles

    def _subscribe_in(self, namespace: str) -> None:
        if namespace == self.namespace:
            return
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self.namespace = namespace
        self.stats = {topic: TopicStats() for topic in self._topics}
        self._data_at = -math.inf
        self._subscriptions = [
            self._node.create_subscription(
                kind, full_name(topic, namespace), partial(self._count, topic),
                _LATCHED_QOS if topic in self._latched else _QOS, raw=True)
            for topic, kind in self._topics.items()]

    def _count(self, topic: str, data: bytes) -> None:
        self.stats[topic].add(data)
        if topic not in self._latched:      # a late subscriber receives old messages of these
            self._data_at = time.monotonic()

    def _update_health(self, data: bytes) -> None:
        array = _deserialize(data, DiagnosticArray)
        if array is not None:
            self.health.update(array)


def _deserialize(data: bytes, kind: type) -> Any:
    try:
        return deserialize_message(data, kind)
    except Exception:       # rmw and rosidl raise many kinds for malformed bytes
        return None
