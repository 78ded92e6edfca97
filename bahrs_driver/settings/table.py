# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The table of all parameters: those of every device, and `sensor`, which selects the device.

The node declares them, `ros2 param describe` shows them, and the README lists them.
Parameters are read once, when the driver starts, except for those that a service reads when it is
called.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from difflib import get_close_matches
from typing import Generic, TypeVar

from bahrs_driver.process.printable import printable
from bahrs_driver.settings.group import DeviceSettings, from_values, parameters
from bahrs_driver.settings.parameter import Parameter, Value

SENSOR = 'sensor'
QOS_PREFIX = 'qos_overrides.'

Settings = TypeVar('Settings', bound=DeviceSettings, covariant=True)


class ParameterTable(Generic[Settings]):
    """The parameters of some devices, each with the dataclass of its settings."""

    def __init__(self, devices: Mapping[str, type[Settings]]) -> None:
        """Merge the parameters; ValueError if two devices define one name differently."""
        self._devices = devices
        sensor = Parameter(SENSOR, next(iter(devices)), 'Device on the port.',
                           choices=tuple(devices))
        rows = {SENSOR: sensor}
        for kind in devices.values():
            for row in parameters(kind()):
                if rows.setdefault(row.name, row) != row:
                    raise ValueError(f'two devices define the parameter {row.name}')
        groups = list(dict.fromkeys(map(_first_group, rows)))
        self.by_name = {name: rows[name] for name in sorted(
            rows, key=lambda name: groups.index(_first_group(name)))}

    def __iter__(self) -> Iterator[Parameter]:
        """Iterate over the parameters; those of a group stand together."""
        return iter(self.by_name.values())

    def values(self, given: Mapping[str, object]) -> dict[str, Value]:
        """Return the value of every parameter; ParameterError if a given one is invalid."""
        values = {row.name: row.convert(given[row.name]) if row.name in given else row.default
                  for row in self}
        for row in self:
            other = row.other_default
            if other and row.name not in given and values[other.parameter] == other.value:
                values[row.name] = other.default
        return values

    def settings(self, values: Mapping[str, Value]) -> tuple[str, Settings]:
        """Return the name and the settings of the device that the values select."""
        sensor = str(values[SENSOR])
        return sensor, from_values(self._devices[sensor], values)

    def why_unused(self, name: str, sensor: str, settings: DeviceSettings) -> str | None:
        """Return why a parameter has no effect with these settings; None if it has one."""
        if name != SENSOR and name not in (row.name for row in parameters(settings)):
            return f'sensor is {sensor}'
        return dict(settings.unused()).get(name)

    def unused(self, names: Collection[str], sensor: str,
               settings: DeviceSettings) -> Iterator[str]:
        """Yield the named parameters that have no effect, each with the reason."""
        for name in self.by_name:
            reason = self.why_unused(name, sensor, settings) if name in names else None
            if reason:
                yield f'{name} ({reason})'


def unknown_parameter(name: str, known: Iterable[str]) -> str:
    """Describe an unknown name, with the known name closest to it."""
    near = get_close_matches(name, known, n=1)
    kind = 'there is no such publisher, subscription or policy' if name.startswith(QOS_PREFIX) \
        else 'there is no such parameter'
    return f'{printable(name)} ({kind}{f", did you mean {near[0]}?" if near else ""})'


def _first_group(name: str) -> str:
    return name.partition('.')[0]
