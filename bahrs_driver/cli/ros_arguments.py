# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Parse the words after --ros-args, which launch files add to every command.

A verb that is a ROS node passes them to ROS. __node renames its own node; __ns selects the driver,
as the option --namespace does: a launch file that pushes a namespace means the driver in it.
"""

from collections.abc import Sequence
import re

_REMAPS = ('-r', '--remap')
_NAMESPACE = re.compile(r'(?:[^:]*:)?__ns:=(.*)', re.DOTALL)


def namespace(for_ros: Sequence[str]) -> str | None:
    """Return the last namespace in the words for ROS."""
    rules = [rule for flag, rule in zip(for_ros, for_ros[1:]) if flag in _REMAPS]
    matches = [match[1] for rule in rules if (match := _NAMESPACE.fullmatch(rule))]
    return matches[-1] if matches else None
