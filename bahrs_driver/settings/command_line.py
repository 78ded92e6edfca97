# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The ROS arguments of a command line: parameter files, rules NAME:=VALUE, remappings FROM:=TO.

A user expects the last value of a parameter to win. In rcl it does not always: a rule, which is
for all nodes, loses to an earlier file that names the node, and of two values with different types
rcl uses the first. But rules in the arguments of the node override all arguments of the process.
So the rules that no later file can override are passed to the node as well.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

MARK, END = '--ros-args', '--'
RULE_FLAGS = ('-p', '--param')
REMAP_FLAGS = ('-r', '--remap')
FILE_FLAG = '--params-file'
# Other flags with a value.
OTHER_FLAGS = ('-e', '--enclave', '--log-level', '--log-config-file', '--log-file-name')


@dataclass
class RosArguments:
    """Parameter files and rules, and remappings, in the order of the command line."""

    sources: list[tuple[str, str]] = field(default_factory=list)    # flag, and file or rule
    remappings: list[str] = field(default_factory=list)
    last_rules: dict[str, str] = field(default_factory=dict)  # after the last file, by name

    @classmethod
    def from_words(cls, words: Sequence[str]) -> 'RosArguments':
        """Parse the words of a command line."""
        found = cls()
        for flag, value in _flags(words):
            if flag == FILE_FLAG and value:
                found.sources.append((flag, value))
                found.last_rules.clear()
            elif flag in RULE_FLAGS:
                found.sources.append((RULE_FLAGS[0], value))
                name = value.partition(':=')[0]
                found.last_rules.pop(name, None)    # a new value also moves to the end
                found.last_rules[name] = value
            elif flag in REMAP_FLAGS:
                found.remappings.append(value)
        return found

    @property
    def files(self) -> list[str]:
        """Return the parameter files."""
        return [value for flag, value in self.sources if flag == FILE_FLAG]

    @property
    def rules(self) -> list[str]:
        """Return the parameter rules."""
        return [value for flag, value in self.sources if flag != FILE_FLAG]

    def node_arguments(self) -> list[str] | None:
        """Return the arguments of the node that repeat the last rules; None without rules."""
        words = [word for rule in self.last_rules.values() for word in (RULE_FLAGS[0], rule)]
        return [MARK, *words] if words else None


def split_arguments(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """
    Split a command line into the command's own arguments and the ROS arguments with their marks.

    Unlike rclpy.utilities.remove_ros_args this reads no file: a pipe can be read only once.
    """
    own: list[str] = []
    for_ros: list[str] = []
    in_ros = False
    for word in words:
        in_ros = in_ros or word == MARK
        (for_ros if in_ros else own).append(word)
        in_ros = in_ros and word != END
    return own, for_ros


def _flags(words: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield each ROS flag that has a value, with the value."""
    rest = iter(split_arguments(words)[1])
    for word in rest:
        if word in (*RULE_FLAGS, *REMAP_FLAGS, FILE_FLAG, *OTHER_FLAGS):
            yield word, next(rest, '')
