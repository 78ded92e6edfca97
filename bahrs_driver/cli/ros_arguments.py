# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The words after --ros-args, which launch files add to every command that they start.

A verb that is a ROS node hands them on to ROS. Its own node is renamed by __node; __ns is where
it looks for the driver, as the option --namespace says it, for a launch file that pushes a
namespace means the driver beside it.
"""

from collections.abc import Sequence
import re

_REMAPS = ('-r', '--remap')
_NAMESPACE = re.compile(r'(?:[^:]*:)?__ns:=(.*)', re.DOTALL)


def namespace(for_ros: Sequence[str]) -> str | None:
    """Return the namespace that the words for ROS ask for; the last one counts."""
    rules = [rule for flag, rule in zip(for_ros, for_ros[1:]) if flag in _REMAPS]
    matches = [match[1] for rule in rules if (match := _NAMESPACE.fullmatch(rule))]
    return matches[-1] if matches else None
