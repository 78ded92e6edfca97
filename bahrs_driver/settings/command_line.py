# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The parameters on a command line: files, and rules NAME:=VALUE.

rcl merges them by the name of the node that each is for, and so a rule can lose to a file that
stands before it: the file if it names the node, where rules are for all nodes; or the first of two
values of different types, of which it keeps both. Rules that are given to the node itself, rather
than to the process, come after all of these. So the last rules go to the node once more.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

RULE_FLAGS = ('-p', '--param')
FILE_FLAG = '--params-file'
# Other flags that take the word after them.
FLAGS_WITH_VALUE = ('-r', '--remap', '-e', '--enclave', '--log-level', '--log-config-file',
                    '--log-file-name')


class ParameterArguments(NamedTuple):
    """Parameter files, in order, and the rules that come after the last of them."""

    files: list[str]
    rules: list[str]

    @classmethod
    def from_words(cls, words: Sequence[str]) -> 'ParameterArguments':
        """Find them among the words of a command line."""
        files: list[str] = []
        rules: dict[str, str] = {}
        for flag, value in _flags(words):
            if flag == FILE_FLAG and value:
                files.append(value)
                rules.clear()
            elif flag in RULE_FLAGS:
                name = value.partition(':=')[0]
                rules.pop(name, None)
                rules[name] = value
        return cls(files, list(rules.values()))

    def node_arguments(self) -> list[str] | None:
        """Return the arguments of a node to which the rules must apply."""
        if not self.rules:
            return None
        return ['--ros-args', *(word for rule in self.rules for word in ('-p', rule))]


def _flags(words: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the flags of ROS that take a value, each with its value."""
    rest, inside = iter(words), False
    for word in rest:
        if word == '--ros-args' or word == '--':
            inside = word == '--ros-args'
        elif inside and word in (*RULE_FLAGS, FILE_FLAG, *FLAGS_WITH_VALUE):
            yield word, next(rest, '')
