# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find the topics of a node as they appear."""

from collections.abc import Callable
import time

from bahrs_driver.bag.stored_message import RAW_TOPIC
from bahrs_driver.devices.driver_graph import NodeSearch, published
from bahrs_driver.ros.node_names import NodeChoice, split_name
from bahrs_driver.units import NS_PER_S
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

# Period of searches, in s: rclpy does not report changes of the graph. A search takes 20 us.
FAST_SEARCH, SLOW_SEARCH = 0.02, 0.2
SETTLED = 2.0               # s without a new topic, after which the slow search begins
DISCOVERY = 10.0            # s within which a node that runs already is found
NEVER_RECORDED = ('parameter_events',)

TopicHandler = Callable[[str, str, list[TopicEndpointInfo]], None]


class TopicSearch:
    """
    Searches for all topics of the chosen node, or only its raw bytes, while `node` is spun.

    on_topic is called with the name, the type and the publishers of each topic that is found.
    """

    def __init__(self, node: Node, choice: NodeChoice, raw_only: bool,
                 on_topic: TopicHandler) -> None:
        self.node_seen = False
        self.node_is_later = False          # whether it certainly started after the search
        self._node = node
        self._node_search = NodeSearch(choice)
        self._raw_only = raw_only
        self._on_topic = on_topic
        self._known: set[str] = set()
        self._start = self._last_found = time.monotonic()
        self._timer = node.create_timer(
            FAST_SEARCH, self._search, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _search(self) -> None:
        now = time.monotonic()
        target = self._node_search.update(self._node, now)
        topics = published(self._node, target) if target else []
        if not topics:
            self._set_period(FAST_SEARCH)
            return
        self.node_is_later |= not self.node_seen and now > self._start + DISCOVERY
        self.node_seen = True
        for name, types in topics:
            if name in self._known or not self._is_wanted(name):
                continue
            publishers = [info for info in self._node.get_publishers_info_by_topic(name)
                          if (info.node_name, info.node_namespace) == split_name(target)]
            if publishers:          # discovery may not have them yet
                self._known.add(name)
                self._last_found = now
                self._on_topic(name, types[0], publishers)
        self._set_period(FAST_SEARCH if now < self._last_found + SETTLED else SLOW_SEARCH)

    def _is_wanted(self, topic: str) -> bool:
        base = topic.rpartition('/')[2]
        return base == RAW_TOPIC if self._raw_only else base not in NEVER_RECORDED

    def _set_period(self, period: float) -> None:
        nanoseconds = round(period * NS_PER_S)
        if self._timer.timer_period_ns != nanoseconds:
            self._timer.timer_period_ns = nanoseconds
