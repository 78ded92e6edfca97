# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Publish the latest state to late subscribers, and every change to the others.

A transient-local publisher sends its whole history to a late subscriber, oldest first. Only a
history of one message makes the latest state the first one that it receives. But with keep last 1
Fast DDS replaces a message even if a subscriber has not acknowledged it. A subscriber that has
missed it, in a stopped process or on a lossy network, never receives it.

So a change waits until the previous one is acknowledged, which takes some 6 ms on one machine. If
a subscriber does not acknowledge within PATIENCE, all changes go to a second, deep publisher of
the same topic: other subscribers need not wait, and the slow one receives all changes in order.
When all are acknowledged, the latest state is published again on the first publisher, and the
second one is destroyed. A late subscriber in that time may receive older states first.

With another depth, set by qos_overrides, every state is published at once.
"""

from collections import deque
from collections.abc import Callable
from threading import Lock
import time
from typing import NamedTuple

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile

PATIENCE = 0.1          # s
BACKLOG = 100           # changes that are kept for a slow subscriber
NO_WAIT = Duration(nanoseconds=0)


class _Waiting(NamedTuple):
    since: float
    message: object


class LatchedPublisher:
    """Publishes states; publish() and flush() may be called from any thread."""

    def __init__(self, latest: Publisher, create: Callable[[], Publisher],
                 destroy: Callable[[Publisher], object], wait: bool = True,
                 clock: Callable[[], float] = time.monotonic) -> None:
        """
        Use a transient-local publisher of depth 1.

        create returns another one of depth BACKLOG, and destroy destroys it. If wait is false,
        every state is published at once on the first one.
        """
        self._latest, self._create, self._destroy = latest, create, destroy
        self._wait, self._clock = wait, clock
        self._lock = Lock()
        self._backlog: Publisher | None = None
        self._waiting: deque[_Waiting] = deque()
        self._latest_state: object = None

    def get_subscription_count(self) -> int:
        """Return the number of matched subscribers."""
        return self._latest.get_subscription_count()

    def publish(self, message: object) -> None:
        """Publish a state now, or when the previous one is acknowledged."""
        with self._lock:
            self._waiting.append(_Waiting(self._clock(), message))
            self._flush()

    def flush(self) -> None:
        """Publish waiting states if possible."""
        if self._waiting:
            with self._lock:
                self._flush()

    @property
    def has_backlog(self) -> bool:
        """Whether states wait for an acknowledgement."""
        return bool(self._waiting or self._backlog)

    def supervise(self) -> None:
        """
        Begin or end the backlog for slow subscribers.

        Call it some ten times a second in the thread that spins the node: it creates and destroys
        publishers.
        """
        with self._lock:
            self._flush()
            if self._backlog:
                self._end_backlog(self._backlog)
            elif self._waiting and self._clock() - self._waiting[0].since > PATIENCE:
                self._backlog = self._create()
                self._flush()

    def _flush(self) -> None:
        while self._waiting and self._may_publish():
            self._latest_state = self._waiting.popleft().message
            (self._backlog or self._latest).publish(self._latest_state)

    def _may_publish(self) -> bool:
        if self._backlog or not self._wait:
            return True
        # The queue stays bounded even if supervise() is not called.
        return _acknowledged(self._latest) or len(self._waiting) > BACKLOG

    def _end_backlog(self, backlog: Publisher) -> None:
        if _acknowledged(self._latest) and _acknowledged(backlog):
            self._latest.publish(self._latest_state)
            self._destroy(backlog)
            self._backlog = None


def _acknowledged(publisher: Publisher) -> bool:
    return publisher.wait_for_all_acked(NO_WAIT)


def create_latched(node: Node, message_type: type, topic: str,
                   create: Callable[[type, str, QoSProfile], Publisher]) -> LatchedPublisher:
    """Create a publisher of states on a topic; create applies the user's qos_overrides."""
    profile, deep = (QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)
                     for depth in (1, BACKLOG))
    latest = create(message_type, topic, profile)
    return LatchedPublisher(
        latest, lambda: node.create_publisher(message_type, topic, deep), node.destroy_publisher,
        wait=profile.depth == 1 and profile.history is HistoryPolicy.KEEP_LAST)
