# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What came on the driver's topics.

Messages are counted as they come and kept as bytes; only what is looked at is deserialised, so
that watching costs the host little.
"""

from collections import deque
from collections.abc import Mapping
from functools import partial
import math
import time
from typing import Any

from bahrs_driver.convert.bahrs import LATCHED, TOPICS as BAHRS_TOPICS
from bahrs_driver.convert.titan_m import TOPICS as TITAN_TOPICS
from bahrs_driver.monitor.values import Attitude, attitude, FORMATS, vertical_force
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

TOPICS = {**BAHRS_TOPICS, **TITAN_TOPICS}
RATE_WINDOW = 2.0           # s over which a rate is measured
DATA_TIMEOUT = 1.5          # s without data, from which on it has stopped
DRIVER_TIMEOUT = 3.5        # s without diagnostics, from which on the driver is gone
EVENTS = 50
DIAGNOSTICS = '/diagnostics'
PREFIX = 'bahrs_driver: '

# Whoever only looks must hold up nobody, so what comes too fast is let go.
_PROFILE = QoSProfile(depth=200, reliability=ReliabilityPolicy.BEST_EFFORT)
_LATCHED_PROFILE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Tally:
    """What came on one topic."""

    def __init__(self) -> None:
        """Start with nothing."""
        self.count = 0
        self.data = b''             # the latest message, serialised
        self._arrivals: deque[float] = deque()

    def add(self, data: bytes) -> None:
        """Count a message and keep it."""
        self.count += 1
        self.data = data
        self._arrivals.append(time.monotonic())
        self._forget(self._arrivals[-1])

    @property
    def age(self) -> float:
        """Seconds since the latest message, as long as it is in the window; else infinite."""
        return time.monotonic() - self._arrivals[-1] if self._arrivals else math.inf

    def rate(self) -> float:
        """Return messages per second over the last RATE_WINDOW."""
        self._forget(time.monotonic())
        if len(self._arrivals) < 2:
            return 0.0
        return (len(self._arrivals) - 1) / (self._arrivals[-1] - self._arrivals[0])

    def _forget(self, now: float) -> None:
        while self._arrivals and now - self._arrivals[0] > RATE_WINDOW:
            self._arrivals.popleft()


class Watch:
    """Listens to the driver's topics."""

    def __init__(self, node: Node) -> None:
        """Subscribe."""
        self.tallies = {topic: Tally() for topic in TOPICS}
        self.health: dict[str, DiagnosticStatus] = {}           # by name of the task
        self.events: deque[tuple[float, str, DiagnosticStatus]] = deque(maxlen=EVENTS)
        self._node = node
        self._offered: set[str] = set()         # topics that somebody publishes
        self._data_at = self._health_at = -math.inf
        self._upward = 0.0          # m/s^2, low-passed specific force along the world's z axis
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        for topic, kind in TOPICS.items():
            profile = _LATCHED_PROFILE if topic in LATCHED else _PROFILE
            node.create_subscription(kind, topic, partial(self._count, topic), profile, raw=True)
        node.create_subscription(DiagnosticArray, DIAGNOSTICS, self._judge, 10)

    def spin(self, seconds: float) -> None:
        """Listen for a while."""
        self._offered = {topic for topic in TOPICS if self._node.count_publishers(topic)}
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self._executor.spin_once(timeout_sec=left)
        imu = self.message('imu/data')
        upward = math.nan if imu is None else vertical_force(imu)
        if not math.isnan(upward):
            self._upward += 0.1 * (upward - self._upward)

    @property
    def heard(self) -> bool:
        """Whether any driver was there."""
        return bool(self.health) or any(tally.count for tally in self.tallies.values())

    @property
    def data_heard(self) -> bool:
        """Whether any sample came."""
        return self._data_at > -math.inf

    @property
    def data_age(self) -> float:
        """Seconds since the latest sample; infinite if there was none."""
        return time.monotonic() - self._data_at

    @property
    def health_age(self) -> float:
        """Seconds since the latest diagnostics; infinite if there were none."""
        return time.monotonic() - self._health_at

    @property
    def z_down(self) -> bool:
        """Whether the driver publishes the device's own axes, with z downward."""
        return self._upward < 0

    def message(self, topic: str) -> Any:
        """Return the latest message of a topic; None if there was none, or no such topic."""
        data = self.tallies[topic].data if topic in self.tallies else b''
        return deserialize_message(data, TOPICS[topic]) if data else None

    def text(self, topic: str) -> str:
        """Return what the latest message of a topic says; nothing if there was none."""
        message = self.message(topic)
        return '' if message is None else FORMATS[topic](message)

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
        angles = None if imu is None else attitude(imu)
        if angles and not self.z_down:
            return angles._replace(pitch=-angles.pitch)
        return angles

    def values(self, task: str) -> Mapping[str, str]:
        """Return what a task of the diagnostics was judged by."""
        status = self.health.get(task)
        return {item.key: item.value for item in status.values} if status else {}

    def _count(self, topic: str, data: bytes) -> None:
        self.tallies[topic].add(data)
        if topic not in LATCHED:            # a late joiner gets those from the past, too
            self._data_at = time.monotonic()

    def _judge(self, array: DiagnosticArray) -> None:
        own_prefix = f"{self._node.get_namespace().rstrip('/')}/{PREFIX}"
        for status in array.status:
            for prefix in (PREFIX, own_prefix):
                if status.name.startswith(prefix):
                    self._note(status.name.removeprefix(prefix), status)

    def _note(self, task: str, status: DiagnosticStatus) -> None:
        self._health_at = time.monotonic()
        before = self.health.get(task)
        if before is not None and before.level != status.level:
            self.events.appendleft((time.time(), task, status))
        self.health[task] = status
