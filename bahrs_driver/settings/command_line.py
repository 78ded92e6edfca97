# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The ROS arguments of a command line: parameter files, rules NAME:=VALUE, remappings FROM:=TO.

rcl merges parameters by the name of the node that each is for. So a rule, which is for all nodes,
loses to an earlier file that names the node. If two values of a parameter have different types,
rcl keeps both and uses the first. Rules that are given to the node itself, rather than to the
process, override all of these. So the node receives the last rules once more.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

MARK, END = '--ros-args', '--'
RULE_FLAGS = ('-p', '--param')
REMAP_FLAGS = ('-r', '--remap')
FILE_FLAG = '--params-file'
# Other flags that take the word after them.
FLAGS_WITH_VALUE = ('-e', '--enclave', '--log-level', '--log-config-file', '--log-file-name')


@dataclass
class RosArguments:
    """Parameter files and rules for parameters, remappings, each in order."""

    sources: list[tuple[str, str]] = field(default_factory=list)    # flag, and file or rule
    remappings: list[str] = field(default_factory=list)
    last_rules: dict[str, str] = field(default_factory=dict)    # after all files, by their names

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
                found.last_rules.pop(name, None)
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
        """Return the rules for parameters."""
        return [value for flag, value in self.sources if flag != FILE_FLAG]

    def node_arguments(self) -> list[str] | None:
        """Return the arguments of a node to which the last rules must apply."""
        if not self.last_rules:
            return None
        return ['--ros-args', *(word for rule in self.last_rules.values()
                                for word in ('-p', rule))]


def split(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """
    Return the own arguments of a command, and those for ROS with their marks.

    Unlike rclpy.utilities.remove_ros_args this reads no file: a pipe can be read only once.
    """
    own: list[str] = []
    for_ros: list[str] = []
    inside = False
    for word in words:
        inside = inside or word == MARK
        (for_ros if inside else own).append(word)
        inside = inside and word != END
    return own, for_ros


def _flags(words: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the flags of ROS that take a value, each with its value."""
    rest = iter(split(words)[1])
    for word in rest:
        if word in (*RULE_FLAGS, *REMAP_FLAGS, FILE_FLAG, *FLAGS_WITH_VALUE):
            yield word, next(rest, '')
