# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What came on the driver's topics.

Messages are counted as they come and kept as bytes; only what is looked at is deserialised, so
that watching costs the host little. A publisher can be anybody, so a message may be no message.
"""

from functools import partial
import math
import time
from typing import Any

from bahrs_driver.devices.driver_graph import NodeSearch
from bahrs_driver.devices.registry import all_formats, all_latched, all_topics
from bahrs_driver.monitor.health import Health
from bahrs_driver.monitor.tally import Tally
from bahrs_driver.monitor.values import Attitude, attitude, attitude_text, FORMATS, vertical_force
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.node_names import full_name, NodeChoice, ROOT, Selection, split_name
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription

LONGEST_WAIT = 0.05         # s to wait for a message before looking at the time
DATA_TIMEOUT = 1.5          # s without data, from which on it has stopped
DRIVER_TIMEOUT = 3.5        # s without diagnostics, from which on the driver is gone
DIAGNOSTICS = '/diagnostics'
STRONGEST_FORCE = 1000.0    # m/s^2; no message of more says which way is up

# A subscriber that only looks must hold up no publisher, and receive from best-effort ones, too.
_PROFILE = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Watch:
    """Listens to the topics of one driver, and to all diagnostics to find it."""

    def __init__(self, node: Node, selection: Selection = Selection()) -> None:
        self._topics, self._latched = all_topics(), all_latched()
        self._formats = {**all_formats(), **FORMATS}
        self.tallies = {topic: Tally() for topic in self._topics}
        self.choice = NodeChoice(selection)
        self.health = Health(self.choice)
        self.namespace = ''
        self._node = node
        self._search = NodeSearch(self.choice)
        self._subscriptions: list[Subscription] = []
        self._offered: set[str] = set()         # topics that somebody publishes
        self._data_at = -math.inf
        self._upward = 0.0          # m/s^2, low-passed specific force along the world's z axis
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        self._listen_in(selection.namespace or ROOT)
        node.create_subscription(DiagnosticArray, DIAGNOSTICS, self._diagnose, _PROFILE, raw=True)

    def spin(self, seconds: float) -> None:
        """Listen for a while."""
        self._offered = {topic for topic in self._topics if self._node.count_publishers(
            full_name(topic, self.namespace))}
        self._search.update(self._node, time.monotonic())
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            # Always the same timeout: with another one rclpy forgets which topics it has yet to
            # serve and begins with the first. On a busy host the last ones would never come.
            self._executor.spin_once(timeout_sec=LONGEST_WAIT)
            if self.choice.chosen:
                self._listen_in(split_name(self.choice.chosen)[1])
        imu = self.message('imu/data')
        upward = math.nan if imu is None else vertical_force(imu)
        if abs(upward) < STRONGEST_FORCE:
            self._upward += 0.1 * (upward - self._upward)

    @property
    def driver(self) -> str:
        """Fully qualified name of the driver, in printable form; empty if it is not known."""
        return printable(self.choice.chosen)

    @property
    def heard(self) -> bool:
        """Whether any driver was there."""
        return bool(self.health.tasks) or any(tally.count for tally in self.tallies.values())

    @property
    def data_heard(self) -> bool:
        """Whether any sample came."""
        return self._data_at > -math.inf

    @property
    def data_age(self) -> float:
        """Seconds since the latest sample; infinite if there was none."""
        return time.monotonic() - self._data_at

    @property
    def z_down(self) -> bool:
        """Whether the driver publishes the device's own axes, with z downward."""
        return self._upward < 0

    def message(self, topic: str) -> Any:
        """Return the latest message of a topic; None without one that can be read."""
        data = self.tallies[topic].data if topic in self.tallies else b''
        return _deserialized(data, self._topics[topic]) if data else None

    def text(self, topic: str) -> str:
        """Return what the latest message of a topic says; nothing if there was none."""
        message = self.message(topic)
        if message is None:
            return 'unreadable' if self.tallies[topic].data else ''
        if topic == 'imu/data':
            return attitude_text(self._flown(attitude(message)))
        return printable(self._formats[topic](message))

    def fresh(self, topic: str) -> Any:
        """Return the latest message of a topic; None if it is of the past."""
        tally = self.tallies.get(topic)
        return self.message(topic) if tally and tally.age < DATA_TIMEOUT else None

    def offered(self, topic: str) -> bool:
        """Return whether somebody publishes a topic, or did."""
        return bool(self.tallies[topic].count) or topic in self._offered

    def attitude(self) -> Attitude | None:
        """Return the present attitude in degrees, roll right, pitch up; None if unknown."""
        imu = self.fresh('imu/data')
        return None if imu is None else self._flown(attitude(imu))

    def _flown(self, angles: Attitude | None) -> Attitude | None:
        """Return an attitude with the pitch upward, whichever axes are published."""
        if angles and not self.z_down:
            return angles._replace(pitch=-angles.pitch)
        return angles

    def _listen_in(self, namespace: str) -> None:
        if namespace == self.namespace:
            return
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        self.namespace = namespace
        self.tallies = {topic: Tally() for topic in self._topics}
        self._data_at = -math.inf
        self._subscriptions = [
            self._node.create_subscription(
                kind, full_name(topic, namespace), partial(self._count, topic),
                _LATCHED_PROFILE if topic in self._latched else _PROFILE, raw=True)
            for topic, kind in self._topics.items()]

    def _count(self, topic: str, data: bytes) -> None:
        self.tallies[topic].add(data)
        if topic not in self._latched:            # a late joiner gets those from the past, too
            self._data_at = time.monotonic()

    def _diagnose(self, data: bytes) -> None:
        array = _deserialized(data, DiagnosticArray)
        if array is not None:
            self.health.update(array)


def _deserialized(data: bytes, kind: type) -> Any:
    try:
        return deserialize_message(data, kind)
    except Exception:       # what rmw and rosidl raise for bytes that are no such message
        return None
