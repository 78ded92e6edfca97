# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The arguments of the launch files, one row each.

An empty value is the same as no value. So a launch file can pass its own arguments on, whether it
got a value for them or not.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from bahrs_driver.devices.registry import DEVICES

TRUE = 'true'
BOOLS = (TRUE, 'false')
LEVELS = ('debug', 'info', 'warn', 'error', 'fatal')

Value = str | float | bool


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ValueError(f'{text!r} is not a number') from error


def _bool(text: str) -> bool:
    return text == TRUE


@dataclass(frozen=True)
class LaunchArgument:
    """An argument, and the parameter of the driver that it sets, if any."""

    name: str
    description: str
    choices: tuple[str, ...] = ()
    parameter: str = ''
    convert: Callable[[str], Value] = str
    default: str = ''

    @property
    def valid(self) -> str:
        """Describe the valid values, for the documentation."""
        if self.choices:
            return ', '.join(f'`{choice}`' for choice in self.choices)
        return 'a number' if self.convert is _number else 'any text'


ARGUMENTS = (
    LaunchArgument('port', 'serial port: a path or URL (default: as params_file says, or '
                           '/dev/ttyUSB0)', parameter='port'),
    LaunchArgument('sensor', 'device on the port (default: as the launch file or params_file '
                             'says)', tuple(DEVICES), parameter='sensor'),
    LaunchArgument('name', 'name of the node', default='bahrs_driver'),
    LaunchArgument('namespace', 'namespace of the node and its topics'),
    LaunchArgument('params_file', 'parameter file, with a key for the node, such as /** '
                                  '(default: config/SENSOR.yaml of this package)'),
    LaunchArgument('frame_id', 'frame of the device', parameter='frame_id'),
    LaunchArgument('publish_static_tf', 'publish the transform from base_link to the frame of the '
                                        'device (default: as params_file says, or true)',
                   BOOLS, 'publish.static_tf', _bool),
    *(LaunchArgument(name, f'position of the device in base_link: {axis}, in m',
                     parameter=f'mounting.{name}', convert=_number)
      for name, axis in (('x', 'forward'), ('y', 'left'), ('z', 'up'))),
    *(LaunchArgument(name, f'{name} of the device in base_link, in rad',
                     parameter=f'mounting.{name}', convert=_number)
      for name in ('roll', 'pitch', 'yaw')),
    LaunchArgument('publish_tf', 'publish the attitude as the transform from the world to '
                                 'base_link (default: as params_file says, or false)',
                   BOOLS, 'publish.tf', _bool),
    LaunchArgument('publish_incomplete', 'how to publish a message with an unavailable component '
                                         '(default: as params_file says, or nan)',
                   ('nan', 'not_reported', 'withhold'), 'publish.incomplete'),
    LaunchArgument('record', 'directory of a bag to record: the driver waits for the recorder'),
    LaunchArgument('rviz', 'start RViz', BOOLS, default='false'),
    LaunchArgument('log_level', 'lowest severity of log messages (default: info)', LEVELS),
    LaunchArgument('respawn', 'start the driver again if it ends', BOOLS, default='false'),
)


def parameter_values(values: Mapping[str, str]) -> dict[str, Value]:
    """Return the parameters that given arguments set; ValueError if a value is not a number."""
    found: dict[str, Value] = {}
    for row in ARGUMENTS:
        if row.parameter and values[row.name]:
            try:
                found[row.parameter] = row.convert(values[row.name])
            except ValueError as error:
                raise ValueError(f'launch argument {row.name}: {error}') from error
    return found
