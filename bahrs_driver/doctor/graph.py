# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check the running drivers, and whether the subscribers of their topics are compatible."""

from collections import Counter
from collections.abc import Iterator
from itertools import product
import shlex
import time

from bahrs_driver.devices.driver_graph import find_drivers, node_names, published
from bahrs_driver.devices.registry import all_topics
from bahrs_driver.doctor import reports
from bahrs_driver.doctor.check_result import advice, CheckResult, good, problem
from bahrs_driver.doctor.commands import RUN_DRIVER, run_driver
from bahrs_driver.ros.node_names import full_name
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.topic_endpoint_info import TopicEndpointInfo

DISCOVERY_TIME = 2.0        # s
DISCOVERY_TIMEOUT = 4.0     # s more, on a busy machine, before no driver is reported
OF_EVERY_NODE = ('/rosout', '/parameter_events')
_POLICIES = ('reliability', 'durability')


def check(node: Node, port: str, seconds: float = DISCOVERY_TIME, command: str = '',
          namespace: str = '') -> Iterator[CheckResult]:
    """
    Check all drivers, or those of a namespace, as a node sees them.

    command starts a driver for the device on the port. Topics in the node's own namespace are
    checked, too, even if other nodes publish them.
    """
    time.sleep(seconds)             # discovery does not report when it is complete
    end = time.monotonic() + DISCOVERY_TIMEOUT
    while not (found := _publishers(node, namespace)) and time.monotonic() < end:
        time.sleep(0.1)
        if _publishers(node, namespace):        # late: the others will be, too
            time.sleep(seconds)
    if not found:
        yield _no_driver(node, namespace, command or run_driver(port))
        return
    for name, topics in found.items():
        yield good('driver', f'{name} publishes {len(topics)} topics'.lstrip())
    yield from reports.check(node, [name for name in found if name])
    wrong = [*_shared_names(node, found),
             *(result for topic in dict.fromkeys([*sum(found.values(), []), reports.DIAGNOSTICS])
               for result in _topic(node, topic))]
    yield from wrong
    if not wrong:
        yield good('subscribers', 'all fit what the driver publishes')


def _publishers(node: Node, namespace: str) -> dict[str, list[str]]:
    """Return the topics of each driver; without a name those that a driver might publish."""
    drivers = {name: [topic for topic, _ in published(node, name)
                      if topic not in (*OF_EVERY_NODE, reports.DIAGNOSTICS)]
               for name in find_drivers(node, namespace)}
    known = set(sum(drivers.values(), []))
    others = [topic for topic in map(node.resolve_topic_name, all_topics())
              if topic not in known and node.get_publishers_info_by_topic(topic)]
    return {**drivers, **({'': others} if others else {})}


def _no_driver(node: Node, namespace: str, command: str) -> CheckResult:
    others = find_drivers(node)
    if not others:
        return advice('driver', 'no driver runs: no subscribers can be checked', command)
    return advice('driver', f'no driver runs in namespace {namespace}, but '
                            f'{" and ".join(others)} elsewhere',
                  shlex.join(['bahrs', 'monitor', '--node', others[0]]))


def _shared_names(node: Node, drivers: dict[str, list[str]]) -> Iterator[CheckResult]:
    count = Counter(node_names(node))
    for name in drivers:
        if count[name] > 1:
            yield problem('driver', f'{count[name]} nodes are named {name}: their diagnostics '
                                    'cannot be distinguished', f'{RUN_DRIVER} --ros-args '
                                    '-r __node:=other')


def _topic(node: Node, topic: str) -> Iterator[CheckResult]:
    publishers = node.get_publishers_info_by_topic(topic)
    if len(publishers) > 1 and topic != reports.DIAGNOSTICS:
        names = ' and '.join(sorted(_name(info) for info in publishers))
        yield problem('publishers', f'{names} both publish {topic}: give one of them a namespace',
                      f'{RUN_DRIVER} --ros-args -r __ns:=/left')
    for publisher, subscriber in product(publishers[:1],
                                         node.get_subscriptions_info_by_topic(topic)):
        yield from _pair(topic, publisher, subscriber)


def _pair(topic: str, publisher: TopicEndpointInfo,
          subscriber: TopicEndpointInfo) -> Iterator[CheckResult]:
    if publisher.topic_type != subscriber.topic_type:
        yield problem('subscribers', f'{_name(subscriber)} subscribes to {topic} as '
                                     f'{subscriber.topic_type}: its type is '
                                     f'{publisher.topic_type}',
                      shlex.join(['ros2', 'topic', 'info', '--verbose', topic]))
        return
    fits, _ = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
    if fits != QoSCompatibility.ERROR:
        return
    for policy in _POLICIES:
        offered = getattr(publisher.qos_profile, policy)
        wanted = getattr(subscriber.qos_profile, policy)
        if offered != wanted:
            yield problem(
                'subscribers', f'{_name(subscriber)} receives nothing on {topic}: it requests '
                f'{policy} {wanted.short_key}, the driver offers {offered.short_key}',
                f'{RUN_DRIVER} --ros-args -p '
                + shlex.quote(f'qos_overrides.{topic}.publisher.{policy}:={wanted.short_key}'))


def _name(info: TopicEndpointInfo) -> str:
    return full_name(info.node_name, info.node_namespace)
