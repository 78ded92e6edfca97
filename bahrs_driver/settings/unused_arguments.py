# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Find ROS arguments without effect: for another node, or for a topic that the node lacks."""

from collections.abc import Iterator
import re

from bahrs_driver.process.printable import printable
from bahrs_driver.settings.command_line import RosArguments
from bahrs_driver.settings.parameter_files import matches_node, other_nodes
from bahrs_driver.settings.type_clashes import ignored_values
from rclpy.node import Node

# Names that every node has, and topics that a launch file remaps for all of its nodes.
_IN_ALL_NODES = ('__node', '__name', '__ns', '/rosout', 'tf', '/tf', 'tf_static', '/tf_static',
                 'clock', '/clock')
_SCHEME = re.compile(r'^(rostopic|rosservice)://')


def unused_arguments(node: Node, arguments: RosArguments) -> Iterator[str]:
    """
    Yield the arguments without effect, each with the reason.

    The node must have all its publishers, subscriptions and services.
    """
    full_name = node.get_fully_qualified_name()
    for file in arguments.files:
        names = other_nodes(file, full_name)
        if names is not None:
            content = f'parameters of {", ".join(names)}' if names else 'no parameters'
            yield (f'parameter file {printable(file)} (it has {printable(content)} only, use the '
                   f'key /** or {full_name})')
    yield from ignored_values(arguments, full_name)
    for rule in arguments.rules:
        owner = _split_rule(rule)[0]
        if owner and not matches_node(owner, full_name):
            yield f'-p {printable(rule)} (it is for node /{printable(owner)})'
    for rule in arguments.remappings:
        owner, name = _split_rule(rule)
        if owner and owner != node.get_name():
            yield f'-r {printable(rule)} (it is for a node {printable(owner)})'
        elif name not in _IN_ALL_NODES and not _is_remapped(node, name):
            yield f'-r {printable(rule)} (there is no such topic or service)'


def _split_rule(rule: str) -> tuple[str, str]:
    """Return the node that a rule is for (empty: all nodes) and the name in the rule."""
    owner, _, name = _SCHEME.sub('', rule.partition(':=')[0]).rpartition(':')
    return owner, _SCHEME.sub('', name)


def _is_remapped(node: Node, name: str) -> bool:
    """Return whether a node has a topic or service that a remapping renamed."""
    try:
        topic, service = node.resolve_topic_name(name), node.resolve_service_name(name)
    except Exception:           # a name that only rcl understands
        return True
    return (topic in {publisher.topic_name for publisher in node.publishers}
            or topic in {subscription.topic_name for subscription in node.subscriptions}
            or service in {item.service_name for item in node.services})
