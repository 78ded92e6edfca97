# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Describe the topics of a bag: type, definition of the type, and quality of service."""

from functools import cache
from typing import NamedTuple

from rosbags.typesys import get_typestore, Stores
from rosbags.typesys.store import Typestore

Qos = dict[str, object]
_FOREVER: Qos = {'sec': 9223372036, 'nsec': 854775807}


class Topic(NamedTuple):
    """A topic: its full name, its type such as std_msgs/msg/Float64, the profiles offered."""

    name: str
    type_name: str
    qos: tuple[Qos, ...]


def qos_profile(history: str, depth: int, reliability: str, durability: str,
                liveliness: str = 'automatic', deadline: Qos = _FOREVER, lifespan: Qos = _FOREVER,
                lease: Qos = _FOREVER) -> Qos:
    """Return a quality of service in the format of rosbag2; times are sec and nsec."""
    return {'history': history, 'depth': depth, 'reliability': reliability,
            'durability': durability, 'deadline': dict(deadline), 'lifespan': dict(lifespan),
            'liveliness': liveliness, 'liveliness_lease_duration': dict(lease),
            'avoid_ros_namespace_conventions': False}


def definition(type_name: str) -> tuple[str, str]:
    """Return the text that defines a type, and its hash; empty if the type is not one of ROS."""
    types = typestore()
    if type_name not in types.types:
        return '', ''
    return types.generate_msgdef(type_name, ros_version=2)[0], types.hash_rihs01(type_name)


@cache
def typestore() -> Typestore:
    """Return the message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)
