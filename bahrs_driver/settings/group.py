# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Settings as frozen dataclasses, each setting with the description of its parameter.

A field of a dataclass is either a setting, declared with setting(), or a group of settings. The
name of a parameter is the path to its field: time.source is the field source of the group time. A
setting with a Literal type accepts only the values of that type.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import get_args, TypeVar

from bahrs_driver.settings.parameter import OtherDefault, Parameter, Value

METADATA_KEY = 'parameter'

Default = TypeVar('Default', bound=Value)


@dataclass(frozen=True)
class Group:
    """A group of settings; all fields have defaults."""


GroupType = TypeVar('GroupType', bound=Group)


@dataclass(frozen=True)
class DeviceSettings(Group):
    """All settings of one device."""

    def unused(self) -> Iterator[tuple[str, str]]:
        """Yield the parameters that the other values make ineffective, each with the reason."""
        yield from ()

    def for_recording(self: GroupType) -> GroupType:
        """Return these settings as the conversion of recorded data needs them."""
        return self

    def for_file(self: GroupType) -> GroupType:
        """Return these settings with the values that the parameter file in config/ recommends."""
        return self


def setting(default: Default, description: str, unit: str = '', *,
            low: float | None = None, high: float | None = None, or_zero: bool = False,
            read_only: bool = True, is_frame: bool = False,
            other_default: OtherDefault | None = None, in_file: bool = True) -> Default:
    """Declare a setting as a field of a Group; see Parameter for the arguments."""
    row = Parameter('', default, description, unit, low, high, or_zero,
                    read_only=read_only, is_frame=is_frame, other_default=other_default,
                    in_file=in_file)
    return field(default=default, metadata={METADATA_KEY: row})


def parameters(group: Group, prefix: str = '') -> Iterator[Parameter]:
    """Yield the parameters of a group; the values of the group become their defaults."""
    for item in fields(group):
        name, value = prefix + item.name, getattr(group, item.name)
        if isinstance(value, Group):
            yield from parameters(value, f'{name}.')
        else:
            yield replace(item.metadata[METADATA_KEY], name=name, default=value,
                          choices=get_args(item.type))


def from_values(kind: type[GroupType], values: Mapping[str, Value],
                prefix: str = '') -> GroupType:
    """Create a group from the values of its parameters: the inverse of parameters()."""
    found: dict[str, object] = {}
    for item in fields(kind):
        name = prefix + item.name
        if isinstance(item.default, Group):
            found[item.name] = from_values(type(item.default), values, f'{name}.')
        else:
            found[item.name] = values[name]
    return replace(kind(), **found)
