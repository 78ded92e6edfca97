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
import math
import threading
import time

from bahrs_driver.bag.arrival_clock import ArrivalLogClock
from bahrs_driver.bag.message_queue import MessageQueue, RecordedMessage
from bahrs_driver.bag.read_metadata import parse_label
from bahrs_driver.bag.reorder_buffer import ReorderBuffer
from bahrs_driver.bag.sequence_count import missed, SequenceCount
from bahrs_driver.bag.stored_message import RAW_TOPIC, RAW_TYPE
from bahrs_driver.bag.topic_search import TopicSearch
from bahrs_driver.bag.topics import Qos, qos_profile, Topic
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.executor import StoppableExecutor
from bahrs_driver.ros.node_names import NodeChoice, Selection
from bahrs_driver.units import NS_PER_S
import rclpy
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy,
)
from rclpy.serialization import deserialize_message
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_msgs.msg import UInt8MultiArray

DEPTH = 5000                # messages of a topic in the queue of the subscription
# Limits of the time for which a later message may overtake an earlier one, in ns.
MIN_HOLD, MAX_HOLD = NS_PER_S // 10, NS_PER_S * 7 // 10


class Recorder:
    """
    Records all topics of the selected node, or only its raw bytes, once start() is called.

    on_error is called with each exception of the recorder's own callbacks.
    """

    def __init__(self, selection: Selection, raw_only: bool,
                 on_error: Callable[[BaseException], None]) -> None:
        self.notes: list[str] = []      # topics that are not recorded, and why
        self.choice = NodeChoice(selection)
        self._counts: dict[str, SequenceCount] = {}
        self._clock = ArrivalLogClock()
        self._new_topics: deque[Topic] = deque()
        self._queue = MessageQueue()
        self._received = ReorderBuffer[RecordedMessage]()
        self._longest_delay = 0         # of callbacks since the latest advance_watermark(), in ns
        self._earlier_delay = 0         # the same before that
        self._node = rclpy.create_node(f'bahrs_record_{time.monotonic_ns() % 10 ** 9}')
        self._search = TopicSearch(self._node, self.choice, raw_only, self._subscribe)
        self._executor = StoppableExecutor(on_error)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, name='recorder')

    @property
    def node_seen(self) -> bool:
        """Whether the selected node was found."""
        return self._search.node_seen

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
        return missed(dict(self._counts), self._clock.start, self._search.node_is_later)

    @property
    def clock_steps(self) -> list[str]:
        """Sentences about each time that the host's clock was set."""
        return self._clock.sentences()

    def advance_watermark(self) -> int:
        """Return the log time in ns up to which all messages have probably been received."""
        delay = max(self._earlier_delay, self._longest_delay)
        self._earlier_delay, self._longest_delay = self._longest_delay, 0
        return self._clock.now() - max(MIN_HOLD, min(2 * delay, MAX_HOLD))

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

    def drain(self, until: float = math.inf) -> list[RecordedMessage]:
        """
        Return the messages since the last call, in the order of log times over all calls.

        Messages after a log time in ns are kept for the next call: an older message may still
        arrive.
        """
        self._received.add((message.log_time, message) for message in self._queue.take_all())
        return [message._replace(log_time=log_time)
                for log_time, message in self._received.pop_until(until)]

    def _subscribe(self, name: str, type_name: str, publishers: list[TopicEndpointInfo]) -> None:
        try:
            package, _, message = type_name.split('/')
            kind = getattr(import_module(f'{package}.msg'), message)
        except (AttributeError, ImportError, ValueError):
            self.notes.append(f'{printable(name)} is left out: its type {printable(type_name)} '
                              'is not installed here')
            return
        self._new_topics.append(Topic(name, type_name, tuple(
            _offered(info.qos_profile) for info in publishers)))
        offered = publishers[0].qos_profile
        wanted = QoSProfile(
            depth=DEPTH, history=HistoryPolicy.KEEP_LAST,
            reliability=offered.reliability, durability=offered.durability)
        is_raw = name.endswith(f'/{RAW_TOPIC}') and type_name == RAW_TYPE
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
            self._longest_delay = max(self._longest_delay, now - log_time)
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


def _offered(qos: QoSProfile) -> Qos:
    """Return the quality of service of a publisher in the format of rosbag2."""
    def duration(value: Duration) -> Qos:
        seconds, nanoseconds = divmod(value.nanoseconds, NS_PER_S)
        return {'sec': seconds, 'nsec': nanoseconds}

    return qos_profile(
        HistoryPolicy(qos.history).name.lower(), qos.depth,
        ReliabilityPolicy(qos.reliability).name.lower(),
        DurabilityPolicy(qos.durability).name.lower(),
        LivelinessPolicy(qos.liveliness).name.lower(),
        duration(qos.deadline), duration(qos.lifespan),
        duration(qos.liveliness_lease_duration))
