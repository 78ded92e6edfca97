# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Subscribe to all topics of a node, and queue their serialized messages.

Two threads: the executor's receives messages and finds topics, and the one that calls drain()
writes. The log time of a message is its arrival, and that of a `raw` message the time of its read,
both without the steps of the host clock (see `log_clock`).
"""

from collections import deque
from collections.abc import Callable
from importlib import import_module
import threading
import time

from bahrs_driver.bag.arrival_clock import ArrivalLogClock
from bahrs_driver.bag.message_queue import MessageQueue, RecordedMessage
from bahrs_driver.bag.read_metadata import parse_label
from bahrs_driver.bag.sequence_count import missed, SequenceCount
from bahrs_driver.bag.stored_message import RAW_TYPE
from bahrs_driver.bag.topics import profile, Qos, Topic
from bahrs_driver.devices.driver_graph import NodeSearch, published
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.executor import StoppableExecutor
from bahrs_driver.ros.node_names import NodeChoice, Selection, split_name
from bahrs_driver.units import NS_PER_S
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy,
)
from rclpy.serialization import deserialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_msgs.msg import UInt8MultiArray

DEPTH = 5000                # messages of a topic in the queue of the subscription
# Period of searches for topics, in s: rclpy does not report changes of the graph. A search takes
# 20 us.
FAST_SEARCH, SLOW_SEARCH = 0.02, 0.2
SETTLED = 2.0               # s without a new topic, after which the slow search begins
DISCOVERY = 10.0            # s within which a node that runs already is found
# Limits of the time for which a later message may overtake an earlier one, in ns.
MIN_HOLD, MAX_HOLD = NS_PER_S // 10, NS_PER_S * 7 // 10
RAW = 'raw'
NEVER_RECORDED = ('parameter_events',)


class Recorder:
    """
    Records all topics of the selected node, or only its raw bytes, once start() is called.

    on_error is called with each exception of the recorder's own callbacks.
    """

    def __init__(self, selection: Selection, raw_only: bool,
                 on_error: Callable[[BaseException], None]) -> None:
        self.node_seen = False
        self.notes: list[str] = []      # topics that are not recorded, and why
        self.choice = NodeChoice(selection)
        self._node_search = NodeSearch(self.choice)
        self._raw_only = raw_only
        self._known: set[str] = set()
        self._counts: dict[str, SequenceCount] = {}
        self._is_new = False            # whether the node certainly started later
        self._clock = ArrivalLogClock()
        self._began = self._found = time.monotonic()
        self._new_topics: deque[Topic] = deque()
        self._queue = MessageQueue()
        self._late: list[RecordedMessage] = []    # kept for the next drain()
        self._last = 0                  # log time of the latest message that drain() returned
        self._delays = [0, 0]           # the latest longest delays of callbacks, in ns
        self._node = rclpy.create_node(f'bahrs_record_{time.monotonic_ns() % 10 ** 9}')
        self._timer = self._node.create_timer(
            FAST_SEARCH, self._search, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._executor = StoppableExecutor(on_error)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, name='recorder')

    @property
    def lost(self) -> int:
        """Messages lost between received ones."""
        return sum(count.lost for count in [*self._counts.values()])

    @property
    def dropped(self) -> int:
        """Messages dropped because earlier ones were not written in time."""
        return self._queue.dropped

    @property
    def missed(self) -> dict[str, int]:
        """Messages of each topic that were published before discovery, by topic."""
        return missed(dict(self._counts), self._clock.began, self._is_new)

    @property
    def clock_steps(self) -> list[str]:
        """Sentences about each time that the host's clock was set."""
        return self._clock.sentences()

    def settled(self) -> int:
        """Return the log time in ns up to which all messages have probably been received."""
        slowest, self._delays[:] = max(self._delays), [self._delays[1], 0]
        return self._clock.now() - max(MIN_HOLD, min(2 * slowest, MAX_HOLD))

    def start(self) -> None:
        """Search for topics and record them, in another thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop receiving. Messages received so far can still be drained."""
        self._executor.stop()
        self._thread.join()

    def new_topics(self) -> list[Topic]:
        """Return the topics that were found since the last call."""
        return [self._new_topics.popleft() for _ in range(len(self._new_topics))]

    def drain(self, until: int | None = None) -> list[RecordedMessage]:
        """
        Return the messages since the last call, in the order of log times over all calls.

        Messages after a log time in ns are kept for the next call: an older message may still
        arrive.
        """
        items = self._late + self._queue.take_all()
        items.sort(key=lambda item: item.log_time)
        self._late = [item for item in items if until is not None and item.log_time > until]
        ready = items[:len(items) - len(self._late)]
        for index, item in enumerate(ready):
            if item.log_time < self._last:
                ready[index] = item._replace(log_time=self._last)
            self._last = ready[index].log_time
        return ready

    def _search(self) -> None:
        """Find and subscribe to new topics of the node."""
        now = time.monotonic()
        target = self._node_search.update(self._node, now)
        topics = published(self._node, target) if target else []
        if not topics:
            self._set_period(FAST_SEARCH)
            return
        self._is_new |= not self.node_seen and now > self._began + DISCOVERY
        self.node_seen = True
        for name, types in topics:
            base = name.rpartition('/')[2]
            if name in self._known or base in NEVER_RECORDED or self._raw_only and base != RAW:
                continue
            offers = [info for info in self._node.get_publishers_info_by_topic(name)
                      if (info.node_name, info.node_namespace) == split_name(target)]
            if offers:              # discovery may not have them yet
                self._subscribe(name, types[0], offers)
                self._found = now
        self._set_period(FAST_SEARCH if now < self._found + SETTLED else SLOW_SEARCH)

    def _set_period(self, period: float) -> None:
        nanoseconds = round(period * NS_PER_S)
        if self._timer.timer_period_ns != nanoseconds:
            self._timer.timer_period_ns = nanoseconds

    def _subscribe(self, name: str, type_name: str, offers: list[TopicEndpointInfo]) -> None:
        self._known.add(name)
        try:
            package, _, message = type_name.split('/')
            kind = getattr(import_module(f'{package}.msg'), message)
        except (AttributeError, ImportError, ValueError):
            self.notes.append(f'{printable(name)} is left out: its type {printable(type_name)} '
                              'is not installed here')
            return
        offered = offers[0].qos_profile
        self._new_topics.append(Topic(name, type_name, tuple(
            _profile(info.qos_profile) for info in offers)))
        wanted = QoSProfile(
            depth=DEPTH, history=HistoryPolicy.KEEP_LAST,
            reliability=offered.reliability, durability=offered.durability)
        is_raw = name.endswith(f'/{RAW}') and type_name == RAW_TYPE
        self._node.create_subscription(
            kind, name, self._callback(name, is_raw),  # type: ignore[arg-type]
            wanted, raw=True)

    def _callback(self, name: str, is_raw: bool) -> Callable[[bytes, dict[str, int]], None]:
        count = self._counts[name] = SequenceCount(lambda: self._node.count_publishers(name) > 1)

        def receive(data: bytes, info: dict[str, int]) -> None:
            now, received = self._clock.now(), info['received_timestamp']
            log_time = self._clock.log_time(now, _read_time(data) if is_raw else None, received)
            sequence = info.get('publication_sequence_number')
            if sequence:
                count.add(sequence, log_time)
            self._delays[1] = max(self._delays[1], now - log_time)
            self._queue.put(RecordedMessage(
                log_time, name, data, info['source_timestamp'] or received or log_time))
        return receive


def _read_time(data: bytes) -> int | None:
    """Return the ROS time of the read of a raw message, if its label has one."""
    try:
        dimensions = deserialize_message(data, UInt8MultiArray).layout.dim
    except Exception:               # malformed bytes of another program
        return None
    metadata = parse_label(dimensions[0].label) if dimensions else None
    return metadata and metadata.ros_ns


def _profile(qos: QoSProfile) -> Qos:
    def duration(value: Duration) -> Qos:
        seconds, nanoseconds = divmod(value.nanoseconds, NS_PER_S)
        return {'sec': seconds, 'nsec': nanoseconds}

    return profile(
        HistoryPolicy(qos.history).name.lower(), qos.depth,
        ReliabilityPolicy(qos.reliability).name.lower(),
        DurabilityPolicy(qos.durability).name.lower(),
        LivelinessPolicy(qos.liveliness).name.lower(),
        duration(qos.deadline), duration(qos.lifespan),
        duration(qos.liveliness_lease_duration))
