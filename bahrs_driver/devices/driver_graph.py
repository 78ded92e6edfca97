# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Find drivers in the ROS graph, under any name and with any remapping.

The graph describes other processes: a node may be gone before it is queried, and its name may be
any text. Neither ends the search.
"""

from collections.abc import Callable
from typing import TypeVar

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.ros.node_names import full_name, NodeChoice, Selection, split_name, USUAL_NAME
from bahrs_driver.ros_layout.layouts import type_name
from rclpy.node import Node

LOOK_PERIOD = 0.2           # s between queries of nodes with other names, which take longer
SELF_TEST = 'diagnostic_msgs/srv/SelfTest'

Item = TypeVar('Item')


def _is_published_by_a_driver(types: set[str]) -> bool:
    """Return whether the types of some topics include all those of one device."""
    return any(set(map(type_name, spec.topics().values())) <= types for spec in DEVICES.values())


def node_names(node: Node) -> list[str]:
    """Return the fully qualified names of all nodes, duplicates included."""
    return [full_name(*found) for found in _query(node.get_node_names_and_namespaces)]


class NodeSearch:
    """Searches the graph for the node that a choice selects."""

    def __init__(self, choice: NodeChoice) -> None:
        self.choice = choice
        self._next_look = 0.0

    def update(self, node: Node, now: float) -> str:
        """Search the graph of a node at a monotonic time in seconds; return the chosen name."""
        if not self.choice.settled(now):
            names = [name for name in node_names(node) if self.choice.selection.matches(name)]
            if not self.choice.selection.name:
                names = self._drivers(node, names, now)
            self.choice.offer(names, now)
        return self.choice.chosen

    def _drivers(self, node: Node, names: list[str], now: float) -> list[str]:
        usual = [name for name in names if split_name(name)[0] == USUAL_NAME]
        if now < self._next_look:
            return usual
        self._next_look = now + LOOK_PERIOD
        return [*usual, *(name for name in names if name not in usual and is_driver(node, name))]


def find_drivers(node: Node, namespace: str = '') -> list[str]:
    """Return the running drivers of a namespace, or of all."""
    selection = Selection('', namespace)
    return [name for name in sorted(set(node_names(node)))
            if selection.matches(name) and is_driver(node, name)]


def is_driver(node: Node, full: str) -> bool:
    """Return whether a node offers the service and the message types of a driver."""
    services = _query(lambda: node.get_service_names_and_types_by_node(*split_name(full)))
    if not any(SELF_TEST in types for _, types in services):
        return False
    return _is_published_by_a_driver(
        {kind for _, types in published(node, full) for kind in types})


def published(node: Node, full: str) -> list[tuple[str, list[str]]]:
    """Return the topics that a node publishes, each with its types; empty if it is gone."""
    return _query(lambda: node.get_publisher_names_and_types_by_node(*split_name(full)))


def _query(query: Callable[[], list[Item]]) -> list[Item]:
    try:
        return query()
    except Exception:       # the node is gone, or rcl rejects its name
        return []
