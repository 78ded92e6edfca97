# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""One parameter: its name, default and limits, and the validation of a given value."""

from dataclasses import dataclass
import math
from typing import NamedTuple

from bahrs_driver.errors import ParameterError
from bahrs_driver.process.printable import printable

Value = str | int | float | bool

LONGEST_VALUE = 80          # characters of a value in a message

_TYPE_NAMES = {bool: 'true or false', int: 'a whole number', float: 'a decimal number',
               str: 'a text'}


class OtherDefault(NamedTuple):
    """The default of a parameter if another parameter has a certain value."""

    parameter: str
    value: Value
    default: Value


@dataclass(frozen=True)
class Parameter:
    """One row of the table of parameters. The default also gives the type."""

    name: str
    default: Value
    description: str
    unit: str = ''
    low: float | None = None
    high: float | None = None
    or_zero: bool = False           # 0 is valid, too
    choices: tuple[str, ...] = ()
    read_only: bool = True          # or a service reads it when it is called
    is_frame: bool = False          # a frame id of tf2
    other_default: OtherDefault | None = None
    # Commented out in the files in config/, because the default depends on something else.
    in_file: bool = True

    @property
    def valid(self) -> str:
        """Describe the valid values, for messages."""
        unit = self.unit and ' ' + self.unit
        if self.choices:
            return ' or '.join(repr(choice) for choice in self.choices)
        if self.low is not None:
            zero = '0 or ' if self.or_zero else ''
            return (f'{zero}{_TYPE_NAMES[type(self.default)]} from {self.low} to '
                    f'{self.high}{unit}')
        if self.is_frame:
            return f'the name of a frame without blanks, such as {self.default!r}'
        if self.default and isinstance(self.default, str):
            return f'a text such as {self.default!r}'
        return _TYPE_NAMES[type(self.default)]

    def convert(self, given: object) -> Value:
        """Validate and normalize a given value; ParameterError if it is invalid."""
        value = given
        if isinstance(self.default, float) and type(given) is int:
            value = _to_float(given)
        if self.choices and isinstance(given, (bool, float)):
            value = str(given).lower()      # to YAML, nan is a number
        if self.is_frame and isinstance(given, str):
            value = given.lstrip('/')
        if isinstance(value, Value) and type(value) is type(self.default) \
                and self._is_allowed(value):
            return value
        raise ParameterError(f'parameter {self.name} is {shown(given)}: it must be {self.valid}')

    def correction(self, given: object) -> str | None:
        """Return a warning if a valid value is used in another form."""
        if not self.is_frame or not str(given).startswith('/'):
            return None
        return (f'parameter {self.name} is {shown(given)}: names of frames have no leading slash, '
                f'{shown(self.convert(given))} is used')

    def _is_allowed(self, value: Value) -> bool:
        """Return whether a value of the right type is within the limits."""
        if isinstance(value, str):
            if self.choices:
                return value in self.choices
            return _is_frame_id(value) if self.is_frame else bool(value.strip())
        if self.low is not None and self.high is not None:
            return self.low <= value <= self.high or self.or_zero and value == 0
        return True


def shown(value: object) -> str:
    """Format a value as a user writes it, on one short line."""
    # rcl returns None for an empty list or map.
    return '[]' if value is None else printable(repr(value), LONGEST_VALUE)


def _to_float(value: int) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _is_frame_id(text: str) -> bool:
    return bool(text) and text.isprintable() and not any(map(str.isspace, text))
