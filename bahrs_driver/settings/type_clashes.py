# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Values that rcl does not use because an earlier value for the same node has another type.

It keeps one value of each type, and uses the first of these types: bool, int, double, string.
With velocity: 1 in one file and velocity: 0.5 in the next it uses 1.
"""

from collections.abc import Iterator
import re
from typing import NamedTuple

from bahrs_driver.process.printable import printable
from bahrs_driver.settings.command_line import FILE_FLAG, RosArguments
from bahrs_driver.settings.parameter_files import load_text, matches_node, VALUES_KEY
import yaml

_BOOLS = {'y', 'yes', 'true', 'on', 'n', 'no', 'false', 'off'}
_INT = re.compile(r'[-+]?(0x[0-9a-fA-F]+|\d+)')
_FLOAT = re.compile(r'[-+]?(\d+\.?\d*([eE][-+]?\d+)?|\.\d+([eE][-+]?\d+)?|\.inf|\.nan)',
                    re.IGNORECASE)
_TYPES = ('bool', 'int', 'double', 'string', 'array')       # in the order of preference of rcl


class _Definition(NamedTuple):
    """A value of a parameter, with the pattern of the nodes that it is for."""

    node: str
    name: str
    kind: str
    text: str


def ignored_values(arguments: RosArguments, node: str) -> Iterator[str]:
    """Yield the last values for a fully qualified node name that rcl does not use."""
    types_seen: dict[tuple[str, str], set[str]] = {}
    ignored: dict[tuple[str, str], str] = {}
    for definition in _definitions(arguments):
        key = definition.node, definition.name
        types = types_seen.setdefault(key, set())
        types.add(definition.kind)
        ignored.pop(key, None)          # only the last value of a parameter matters
        if min(types, key=_TYPES.index) != definition.kind:
            ignored[key] = f'{definition.name}: {definition.text}'
    for (owner, name), text in ignored.items():
        if matches_node(owner, node) and name not in arguments.last_rules:
            yield (f'{printable(text)} (rcl uses an earlier value of another type: write both '
                   'in the same form)')


def _definitions(arguments: RosArguments) -> Iterator[_Definition]:
    for flag, source in arguments.sources:
        try:
            if flag == FILE_FLAG:
                for document in yaml.compose_all(load_text(source) or '', Loader=yaml.SafeLoader):
                    yield from _in_document(document, '')
            else:
                yield from _in_rule(source)
        except (OSError, ValueError, RecursionError, yaml.YAMLError):
            continue                    # rcl reports it


def _in_rule(rule: str) -> Iterator[_Definition]:
    name, _, text = rule.partition(':=')
    owner, _, name = name.rpartition(':')
    value = yaml.compose(text, Loader=yaml.SafeLoader)
    if value is not None:
        yield _Definition(owner or '/**', name, _type(value), text)


def _in_document(tree: yaml.Node, prefix: str) -> Iterator[_Definition]:
    for key, value in _items(tree):
        if key.startswith(VALUES_KEY):
            yield from _in_parameters(value, prefix, '')
        else:
            yield from _in_document(value, f'{prefix}/{key}' if prefix else key)


def _in_parameters(tree: yaml.Node, node: str, prefix: str) -> Iterator[_Definition]:
    for key, value in _items(tree):
        if isinstance(value, yaml.MappingNode):
            yield from _in_parameters(value, node, f'{prefix}{key}.')
        else:
            yield _Definition(node, prefix + key, _type(value), str(value.value))


def _items(tree: yaml.Node) -> Iterator[tuple[str, yaml.Node]]:
    if isinstance(tree, yaml.MappingNode):
        yield from ((str(key.value), value) for key, value in tree.value)


def _type(value: yaml.Node) -> str:
    """Return the type of a value to rcl."""
    if not isinstance(value, yaml.ScalarNode):
        return 'array'
    if value.style in ('"', "'") or value.tag.endswith(':binary'):
        return 'string'
    if value.value.lower() in _BOOLS:
        return 'bool'
    if _INT.fullmatch(value.value):
        return 'int'
    return 'double' if _FLOAT.fullmatch(value.value) else 'string'
