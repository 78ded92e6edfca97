# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Who publishes and who listens on the driver's topics, and whether they can understand."""

from collections.abc import Iterator
from itertools import product
import time
from typing import Any

from bahrs_driver.convert.bahrs import TOPICS as BAHRS_TOPICS
from bahrs_driver.convert.titan_m import TOPICS as TITAN_TOPICS
from bahrs_driver.doctor.finding import advice, Finding, good, problem
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility

TOPICS = {**BAHRS_TOPICS, **TITAN_TOPICS}
DISCOVERY_TIME = 2.0        # s
PATIENCE = 4.0              # s more, on a busy machine, before there is said to be no driver
DIAGNOSTICS = '/diagnostics'
_POLICIES = ('reliability', 'durability')


def look(node: Node, port: str, seconds: float = DISCOVERY_TIME) -> Iterator[Finding]:
    """
    Yield what is so about the topics of the driver in the namespace of a node.

    port is that of the device, for the command that starts a driver.
    """
    time.sleep(seconds)             # what is there can only be waited for
    topics = [node.resolve_topic_name(name) for name in TOPICS]
    end = time.monotonic() + PATIENCE
    while not (offered := _offered(node, topics)) and time.monotonic() < end:
        time.sleep(0.1)
        if _offered(node, topics):      # late: so will be the others
            time.sleep(seconds)
    if not offered:
        yield advice('driver', 'no driver is heard: nothing to compare subscribers with',
                     f'ros2 run bahrs_driver driver_node --ros-args -p port:={port}')
        return
    yield good('driver', f'publishes {len(offered)} topics')
    wrong = [finding for name in [*offered, DIAGNOSTICS] for finding in _topic(node, name)]
    yield from wrong
    if not wrong:
        yield good('subscribers', 'all fit what the driver publishes')


def _offered(node: Node, topics: list[str]) -> list[str]:
    return [name for name in topics if node.get_publishers_info_by_topic(name)]


def _topic(node: Node, topic: str) -> Iterator[Finding]:
    publishers = node.get_publishers_info_by_topic(topic)
    if len(publishers) > 1 and topic != DIAGNOSTICS:
        names = ' and '.join(sorted(_name(info) for info in publishers))
        yield problem('publishers', f'{names} both publish {topic}: give one of them a namespace',
                      'ros2 run bahrs_driver driver_node --ros-args -r __ns:=/left')
    for publisher, subscriber in product(publishers[:1],
                                         node.get_subscriptions_info_by_topic(topic)):
        yield from _pair(topic, publisher, subscriber)


def _pair(topic: str, publisher: Any, subscriber: Any) -> Iterator[Finding]:
    if publisher.topic_type != subscriber.topic_type:
        yield problem('subscribers', f'{_name(subscriber)} takes {topic} for a '
                                     f'{subscriber.topic_type}: it is a {publisher.topic_type}',
                      f'ros2 topic info --verbose {topic}')
        return
    fits, _ = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
    if fits != QoSCompatibility.ERROR:
        return
    for policy in _POLICIES:
        offered = getattr(publisher.qos_profile, policy)
        wanted = getattr(subscriber.qos_profile, policy)
        if offered != wanted:
            yield problem(
                'subscribers', f'{_name(subscriber)} hears nothing of {topic}: it wants '
                f'{policy} {wanted.short_key}, the driver offers {offered.short_key}',
                'ros2 run bahrs_driver driver_node --ros-args -p '
                f'qos_overrides.{topic}.publisher.{policy}:={wanted.short_key}')


def _name(info: Any) -> str:
    return f"{info.node_namespace.rstrip('/')}/{info.node_name}"
