# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Settings as frozen dataclasses, and the parameters that they stand for.

Each field of a dataclass is a setting, made by setting(), or a group of settings. The parameter of
a setting has the names of its groups and its own, with dots between: time.source is the field
source of the group time. The choices of a setting are those of its Literal type.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import get_args, TypeVar

from bahrs_driver.settings.parameter import Parameter, Value

ROW = 'parameter'           # key of the metadata of a field

Default = TypeVar('Default', bound=Value)


@dataclass(frozen=True)
class Group:
    """A group of settings; all fields have defaults."""


GroupType = TypeVar('GroupType', bound=Group)


@dataclass(frozen=True)
class DeviceSettings(Group):
    """All settings of one device."""

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that have no effect beside the others, each with the reason."""
        yield from ()

    def for_recording(self: GroupType) -> GroupType:
        """Return the settings with which recorded data is converted."""
        return self

    def for_file(self: GroupType) -> GroupType:
        """Return the settings that the parameter file in config/ recommends."""
        return self


def setting(default: Default, description: str, unit: str = '', *,
            low: float | None = None, high: float | None = None, or_zero: bool = False,
            read_only: bool = True, is_frame: bool = False) -> Default:
    """Return the field of a setting; see Parameter for the arguments."""
    row = Parameter('', default, description, unit, low, high, or_zero,
                    read_only=read_only, is_frame=is_frame)
    return field(default=default, metadata={ROW: row})


def parameters(group: Group, prefix: str = '') -> Iterator[Parameter]:
    """Yield the parameters of the settings in a group, with their values as defaults."""
    for item in fields(group):
        name, value = prefix + item.name, getattr(group, item.name)
        if isinstance(value, Group):
            yield from parameters(value, f'{name}.')
        else:
            yield replace(item.metadata[ROW], name=name, default=value,
                          choices=get_args(item.type))


def from_values(kind: type[GroupType], values: Mapping[str, Value],
                prefix: str = '') -> GroupType:
    """Return settings from the values of their parameters."""
    return replace(kind(), **{
        item.name: from_values(type(item.default), values, f'{prefix}{item.name}.')
        if isinstance(item.default, Group) else values[prefix + item.name]
        for item in fields(kind)})
