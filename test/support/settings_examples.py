# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Settings for tests: of a device, with random values, and recorded when read."""

from typing import Any

from bahrs_driver.devices.parts import Parts
from bahrs_driver.devices.registry import DEVICES, parameter_table
from bahrs_driver.settings.group import Group
from bahrs_driver.settings.parameter import Parameter
from hypothesis import strategies as st


def settings_of(sensor: str = 'bahrs', **changes: object) -> Any:
    """Return the settings of a device, changed by the names of parameters."""
    table = parameter_table()
    return table.settings(table.values({'sensor': sensor, **changes}))[1]


def parts_of(sensor: str = 'bahrs', **changes: object) -> Parts:
    """Return the parts of a device, with settings changed by the names of parameters."""
    return DEVICES[sensor].parts(settings_of(sensor, **changes))


def values_of(parameter: Parameter) -> st.SearchStrategy[Any]:
    """Return a strategy for the valid values of a parameter."""
    if parameter.choices:
        return st.sampled_from(parameter.choices)
    if isinstance(parameter.default, bool):
        return st.booleans()
    if isinstance(parameter.default, int):
        assert parameter.low is not None and parameter.high is not None
        return st.integers(int(parameter.low), int(parameter.high))
    if isinstance(parameter.default, float):
        zero = st.just(0.0) if parameter.or_zero else st.nothing()
        # A number that is too small for all of its digits is a text to rcl.
        return zero | st.floats(parameter.low, parameter.high, allow_subnormal=False)
    return st.just(parameter.default)


class RecordedSettings:
    """Settings that remember which of them were read, by the names of their parameters."""

    def __init__(self, group: Group, prefix: str = '', read: set[str] | None = None) -> None:
        self.read: set[str] = set() if read is None else read
        self._group, self._prefix = group, prefix

    def __getattr__(self, name: str) -> Any:
        """Return a setting and record it, or a group whose settings are recorded, too."""
        value = getattr(self._group, name)
        if isinstance(value, Group):
            return RecordedSettings(value, f'{self._prefix}{name}.', self.read)
        self.read.add(self._prefix + name)
        return value
