# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check the running drivers, and whether the subscribers of their topics are compatible."""

from collections import Counter
from collections.abc import Iterator
from itertools import product
import shlex
import time

from bahrs_driver.convert.transforms import TF, TF_STATIC
from bahrs_driver.devices.driver_graph import find_drivers, node_names, published
from bahrs_driver.devices.registry import all_topics
from bahrs_driver.doctor import driver_health
from bahrs_driver.doctor.check_result import advice, CheckResult, ok, problem
from bahrs_driver.doctor.commands import driver_command, run_driver
from bahrs_driver.doctor.driver_health import DIAGNOSTICS
from bahrs_driver.ros.node_names import full_name
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.topic_endpoint_info import TopicEndpointInfo

DISCOVERY_TIME = 2.0        # s
POLL_PERIOD = 0.1           # s
DISCOVERY_TIMEOUT = 4.0     # s more for the first driver, on a busy machine
# Other nodes publish them, too.
COMMON_TOPICS = ('/rosout', '/parameter_events', TF, TF_STATIC, DIAGNOSTICS)
Drivers = dict[str, list[str]]      # names of the nodes, with their topics

_POLICIES = ('reliability', 'durability')


def check(node: Node, port: str, seconds: float = DISCOVERY_TIME, command: str = '',
          namespace: str = '') -> Iterator[CheckResult]:
    """
    Check all drivers, or those of a namespace, as a node sees them.

    command starts a driver for the device on the port. Topics in the node's own namespace are
    checked even if other nodes publish them.
    """
    drivers, other_topics = _discover(node, namespace, seconds)
    if not drivers and not other_topics:
        yield _no_driver(node, namespace, command or run_driver(port))
        return
    for name, topics in drivers.items():
        yield ok('driver', f'{name} publishes {len(topics)} topics')
    if other_topics:
        yield ok('driver', f'other nodes publish {len(other_topics)} topics of a driver')
    yield from driver_health.check(node, list(drivers))
    all_published = dict.fromkeys([*sum(drivers.values(), []), *other_topics, DIAGNOSTICS])
    problems = [*_shared_names(node, drivers),
                *(result for topic in all_published for result in _check_topic(node, topic))]
    yield from problems
    if not problems:
        yield ok('subscribers', 'all are compatible with the publishers of the driver')


def _discover(node: Node, namespace: str, seconds: float) -> tuple[Drivers, list[str]]:
    """Return the topics of each driver, and topics of a driver that other nodes publish."""
    time.sleep(seconds)             # discovery does not report when it is complete
    end = time.monotonic() + DISCOVERY_TIMEOUT
    found = _find_topics(node, namespace)
    while not any(found) and time.monotonic() < end:
        time.sleep(POLL_PERIOD)
        found = _find_topics(node, namespace)
        if any(found):              # late: other nodes may be even later
            time.sleep(seconds)
            found = _find_topics(node, namespace)
    return found


def _find_topics(node: Node, namespace: str) -> tuple[Drivers, list[str]]:
    drivers = {name: [topic for topic, _ in published(node, name) if topic not in COMMON_TOPICS]
               for name in find_drivers(node, namespace)}
    known = set(sum(drivers.values(), []))
    others = [topic for topic in map(node.resolve_topic_name, all_topics())
              if topic not in known and node.get_publishers_info_by_topic(topic)]
    return drivers, others


def _no_driver(node: Node, namespace: str, command: str) -> CheckResult:
    others = find_drivers(node)
    if not others:
        return advice('driver', 'no driver runs: no subscribers can be checked', command)
    return advice('driver', f'no driver runs in namespace {namespace}, but '
                            f'{" and ".join(others)} elsewhere',
                  shlex.join(['bahrs', 'monitor', '--node', others[0]]))


def _shared_names(node: Node, drivers: Drivers) -> Iterator[CheckResult]:
    count = Counter(node_names(node))
    for name in drivers:
        if count[name] > 1:
            yield problem('driver', f'{count[name]} nodes are named {name}: their diagnostics '
                                    'cannot be distinguished',
                          driver_command('-r', '__node:=other'))


def _check_topic(node: Node, topic: str) -> Iterator[CheckResult]:
    publishers = node.get_publishers_info_by_topic(topic)
    if len(publishers) > 1 and topic != DIAGNOSTICS:
        names = ' and '.join(sorted(_name(info) for info in publishers))
        yield problem('publishers', f'{names} both publish {topic}: give one of them a namespace',
                      driver_command('-r', '__ns:=/left'))
    for publisher, subscriber in product(publishers[:1],
                                         node.get_subscriptions_info_by_topic(topic)):
        yield from _check_pair(topic, publisher, subscriber)


def _check_pair(topic: str, publisher: TopicEndpointInfo,
                subscriber: TopicEndpointInfo) -> Iterator[CheckResult]:
    if publisher.topic_type != subscriber.topic_type:
        yield problem('subscribers', f'{_name(subscriber)} subscribes to {topic} as '
                                     f'{subscriber.topic_type}: its type is '
                                     f'{publisher.topic_type}',
                      shlex.join(['ros2', 'topic', 'info', '--verbose', topic]))
        return
    compatibility, _ = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
    if compatibility != QoSCompatibility.ERROR:
        return
    for policy in _POLICIES:
        offered = getattr(publisher.qos_profile, policy)
        wanted = getattr(subscriber.qos_profile, policy)
        if offered != wanted:
            yield problem(
                'subscribers', f'{_name(subscriber)} receives nothing on {topic}: it requests '
                f'{policy} {wanted.short_key}, the driver offers {offered.short_key}',
                driver_command(
                    '-p', f'qos_overrides.{topic}.publisher.{policy}:={wanted.short_key}'))


def _name(info: TopicEndpointInfo) -> str:
    return full_name(info.node_name, info.node_namespace)
