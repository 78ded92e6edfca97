# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Listens to the topics of a node, whichever they are, and hands on what comes, serialised.

Two threads: the executor's takes messages and finds topics, and the one that calls drain()
writes. Log times are those of arrival; that of a `raw` message is the time of its read.
"""

from collections import deque
from collections.abc import Callable
from importlib import import_module
import threading
import time
from typing import Any, NamedTuple

from bahrs_driver.executor import StoppableExecutor
from bahrs_driver.recording.origin import parse_label
from bahrs_driver.recording.topics import profile, Qos, Topic
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.node import NodeNameNonExistentError
from rclpy.qos import (
    DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy,
)
from rclpy.serialization import deserialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_msgs.msg import UInt8MultiArray

DEPTH = 5000                # messages of a topic that may wait for us
SEARCH_PERIOD = 0.2         # s from one look for topics to the next
NANOSECONDS = 1_000_000_000
RAW = 'raw'
NEVER_RECORDED = ('parameter_events',)
RAW_TYPE = 'std_msgs/msg/UInt8MultiArray'


class Taken(NamedTuple):
    """A message as it came. Times are ROS times in ns."""

    log_time: int
    topic: str
    data: bytes
    publish_time: int


class Recorder:
    """Subscribes to all that a node publishes, or only to its raw bytes."""

    def __init__(self, node_name: str, namespace: str, raw_only: bool,
                 on_error: Callable[[BaseException], None]) -> None:
        """
        Record the node of a name and namespace, once start() is called.

        on_error is called with each exception of the recorder's own callbacks.
        """
        self.node_seen = False
        self.lost = 0                   # messages that the publisher sent and we never had
        self._name, self._namespace = node_name, '/' + namespace.strip('/')
        self._raw_only = raw_only
        self._known: set[str] = set()
        self._sequence: dict[str, int] = {}
        self._shared: set[str] = set()  # topics of several publishers, each of which counts
        self._new_topics: deque[Topic] = deque()
        self._taken: deque[Taken] = deque()
        self._late: list[Taken] = []    # that drain() keeps back
        self._last = 0                  # log time of the latest that was handed on
        self._node = rclpy.create_node(f'bahrs_record_{time.monotonic_ns() % 10 ** 9}')
        self._node.create_timer(SEARCH_PERIOD, self._search,
                                clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._executor = StoppableExecutor(on_error)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, name='recorder')

    def start(self) -> None:
        """Begin to look and to listen."""
        self._thread.start()

    def stop(self) -> None:
        """Stop receiving. What came by now can still be drained."""
        self._executor.stop()
        self._thread.join()

    def new_topics(self) -> list[Topic]:
        """Return the topics that were found since the last call."""
        return [self._new_topics.popleft() for _ in range(len(self._new_topics))]

    def drain(self, until: int | None = None) -> list[Taken]:
        """
        Return what came since the last call, by log time and never before what was returned.

        What came after a ROS time in ns is kept for the next call, so that what is older and
        still on its way comes before it.
        """
        items = self._late + [self._taken.popleft() for _ in range(len(self._taken))]
        items.sort(key=lambda item: item.log_time)
        self._late = [item for item in items if until is not None and item.log_time > until]
        ready = items[:len(items) - len(self._late)]
        for index, item in enumerate(ready):
            if item.log_time < self._last:
                ready[index] = item._replace(log_time=self._last)
            self._last = ready[index].log_time
        return ready

    def _search(self) -> None:
        try:
            found = self._node.get_publisher_names_and_types_by_node(self._name, self._namespace)
        except NodeNameNonExistentError:
            return
        self.node_seen = True
        for name, types in found:
            base = name.rpartition('/')[2]
            if name in self._known or base in NEVER_RECORDED or self._raw_only and base != RAW:
                continue
            offers = [info for info in self._node.get_publishers_info_by_topic(name)
                      if info.node_name == self._name]
            if offers:              # discovery may not have them yet
                self._subscribe(name, types[0], offers)

    def _subscribe(self, name: str, type_name: str, offers: list[TopicEndpointInfo]) -> None:
        self._known.add(name)
        package, _, message = type_name.split('/')
        kind = getattr(import_module(f'{package}.msg'), message)
        offered = offers[0].qos_profile
        self._new_topics.append(Topic(name, type_name, tuple(
            _profile(info.qos_profile) for info in offers)))
        wanted = QoSProfile(
            depth=DEPTH, history=HistoryPolicy.KEEP_LAST,
            reliability=offered.reliability, durability=offered.durability)
        log_time = _read_time if name.endswith(f'/{RAW}') and type_name == RAW_TYPE else None
        self._node.create_subscription(
            kind, name, self._taker(name, log_time),  # type: ignore[arg-type]
            wanted, raw=True)

    def _taker(self, name: str, log_time: Callable[[bytes], int | None] | None
               ) -> Callable[[bytes, dict[str, Any]], None]:
        def take(data: bytes, info: dict[str, Any]) -> None:
            arrival = info['received_timestamp'] or time.time_ns()
            self._count_lost(name, info.get('publication_sequence_number'))
            self._taken.append(Taken(log_time and log_time(data) or arrival, name, data,
                                     info['source_timestamp'] or arrival))
        return take

    def _count_lost(self, name: str, sequence: int | None) -> None:
        if sequence is None or name in self._shared:
            return
        last = self._sequence.get(name)
        if last is not None and sequence != last + 1 and self._node.count_publishers(name) > 1:
            self._shared.add(name)
        elif last is not None and sequence > last + 1:
            self.lost += sequence - last - 1
        self._sequence[name] = sequence


def _read_time(data: bytes) -> int | None:
    """Return when the bytes of a raw message were read, if it says so."""
    dimensions = deserialize_message(data, UInt8MultiArray).layout.dim
    origin = parse_label(dimensions[0].label) if dimensions else None
    return origin and origin.ros_ns


def _profile(qos: QoSProfile) -> Qos:
    def duration(value: Any) -> Qos:
        seconds, nanoseconds = divmod(value.nanoseconds, NANOSECONDS)
        return {'sec': seconds, 'nsec': nanoseconds}

    return profile(
        HistoryPolicy(qos.history).name.lower(), qos.depth,
        ReliabilityPolicy(qos.reliability).name.lower(),
        DurabilityPolicy(qos.durability).name.lower(),
        LivelinessPolicy(qos.liveliness).name.lower(),
        duration(qos.deadline), duration(qos.lifespan),
        duration(qos.liveliness_lease_duration))
