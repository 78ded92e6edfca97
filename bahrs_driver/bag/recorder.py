# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Listens to the topics of a node, whichever they are, and hands on what comes, serialised.

Two threads: the executor's takes messages and finds topics, and the one that calls drain()
writes. Log times are those of arrival, and of a `raw` message that of its read, without
the steps of the host clock (see `log_clock`).
"""

from collections import deque
from collections.abc import Callable
from importlib import import_module
import threading
import time

from bahrs_driver.bag.arrival_clock import ArrivalLogClock
from bahrs_driver.bag.message_queue import Taken, TakenQueue
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

DEPTH = 5000                # messages of a topic that may wait for us
# From one look for topics to the next, in s: rclpy does not report that the graph has changed.
# A look takes 20 us.
FAST_SEARCH, SLOW_SEARCH = 0.02, 0.2
SETTLED = 2.0               # s without another topic, after which the slow search begins
DISCOVERY = 10.0            # s within which a node that is there before us is found
# For how long a message may be overtaken by others, in ns: by the delays that were seen.
LEAST_HOLD, LONGEST_HOLD = NS_PER_S // 10, NS_PER_S * 7 // 10
RAW = 'raw'
NEVER_RECORDED = ('parameter_events',)


class Recorder:
    """Subscribes to all that a node publishes, or only to its raw bytes."""

    def __init__(self, selection: Selection, raw_only: bool,
                 on_error: Callable[[BaseException], None]) -> None:
        """
        Record the selected node, once start() is called.

        on_error is called with each exception of the recorder's own callbacks.
        """
        self.node_seen = False
        self.notes: list[str] = []      # what is not recorded, and why
        self.choice = NodeChoice(selection)
        self._node_search = NodeSearch(self.choice)
        self._raw_only = raw_only
        self._known: set[str] = set()
        self._counts: dict[str, SequenceCount] = {}
        self._is_new = False            # whether the node certainly began after us
        self._clock = ArrivalLogClock()
        self._began = self._found = time.monotonic()
        self._new_topics: deque[Topic] = deque()
        self._taken = TakenQueue()
        self._late: list[Taken] = []    # that drain() keeps back
        self._last = 0                  # log time of the latest that was handed on
        self._delays = [0, 0]           # longest from arrival to being taken, of late, in ns
        self._node = rclpy.create_node(f'bahrs_record_{time.monotonic_ns() % 10 ** 9}')
        self._timer = self._node.create_timer(
            FAST_SEARCH, self._search, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._executor = StoppableExecutor(on_error)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, name='recorder')

    @property
    def lost(self) -> int:
        """How many messages were published between those that came, and did not come."""
        return sum(count.lost for count in [*self._counts.values()])

    @property
    def dropped(self) -> int:
        """How many messages came and were dropped, as those before were not written in time."""
        return self._taken.dropped

    @property
    def missed(self) -> dict[str, int]:
        """How many messages of each topic were published before we had found each other."""
        return missed(dict(self._counts), self._clock.began, self._is_new)

    @property
    def clock_steps(self) -> list[str]:
        """Return a sentence for each time that the host's clock was set."""
        return self._clock.sentences()

    def settled(self) -> int:
        """Return the log time in ns up to which all has probably been taken."""
        slowest, self._delays[:] = max(self._delays), [self._delays[1], 0]
        return self._clock.now() - max(LEAST_HOLD, min(2 * slowest, LONGEST_HOLD))

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

        What came after a log time in ns is kept for the next call, so that what is older and
        still on its way comes before it.
        """
        items = self._late + self._taken.take_all()
        items.sort(key=lambda item: item.log_time)
        self._late = [item for item in items if until is not None and item.log_time > until]
        ready = items[:len(items) - len(self._late)]
        for index, item in enumerate(ready):
            if item.log_time < self._last:
                ready[index] = item._replace(log_time=self._last)
            self._last = ready[index].log_time
        return ready

    def _search(self) -> None:
        """Find the topics of the node that are not known yet."""
        now = time.monotonic()
        target = self._node_search.update(self._node, now)
        topics = published(self._node, target) if target else []
        if not topics:
            self._look_again(FAST_SEARCH)
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
        self._look_again(FAST_SEARCH if now < self._found + SETTLED else SLOW_SEARCH)

    def _look_again(self, period: float) -> None:
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
            kind, name, self._taker(name, is_raw),  # type: ignore[arg-type]
            wanted, raw=True)

    def _taker(self, name: str, is_raw: bool) -> Callable[[bytes, dict[str, int]], None]:
        count = self._counts[name] = SequenceCount(lambda: self._node.count_publishers(name) > 1)

        def take(data: bytes, info: dict[str, int]) -> None:
            now, received = self._clock.now(), info['received_timestamp']
            log_time = self._clock.log_time(now, _read_time(data) if is_raw else None, received)
            sequence = info.get('publication_sequence_number')
            if sequence:
                count.add(sequence, log_time)
            self._delays[1] = max(self._delays[1], now - log_time)
            self._taken.put(Taken(
                log_time, name, data, info['source_timestamp'] or received or log_time))
        return take


def _read_time(data: bytes) -> int | None:
    """Return when the bytes of a raw message were read, in ROS time, if it says so."""
    try:
        dimensions = deserialize_message(data, UInt8MultiArray).layout.dim
    except Exception:               # bytes that another program published
        return None
    origin = parse_label(dimensions[0].label) if dimensions else None
    return origin and origin.ros_ns


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
