# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The launch description of one driver node, and of a recorder and RViz beside it.

A value of the node comes from a given argument, else from the parameter file, else it is a
default. An omitted argument passes nothing on. A default that only the launch files have is a rule
before the file, which the file overrides; a given argument is a rule after it.

Launch keeps arguments in the scope of the including file, where the next included file finds them.
So the description has a scope of its own, and marks a value that an earlier include of this
package has used: a later include ignores it. Other launch files see the value as it was. Give a
namespace for several drivers to each include.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from bahrs_driver.devices.registry import DEFAULT, DEVICES
from bahrs_driver.node.launch_arguments import (
    ARGUMENTS, LaunchArgument, parameter_values, TRUE, Value,
)
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from launch.actions import DeclareLaunchArgument, GroupAction, LogInfo, OpaqueFunction
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.descriptions import Parameter
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'bahrs_driver'
RECORDER_TIMEOUT = 10.0         # s that the driver waits for the recorder
RESPAWN_DELAY = 2.0             # s


class UsedValue(str):
    """The value of an argument that was given to an earlier include of this package."""


def describe_driver(launch_file: str) -> LaunchDescription:
    """Describe a driver for the device that the launch file DEVICE.launch.py is named after."""
    device = DEVICES[Path(launch_file).name.partition('.')[0]].name
    return LaunchDescription([
        GroupAction([
            OpaqueFunction(function=_drop_used_values),
            *map(_declaration, ARGUMENTS),
            OpaqueFunction(function=_start, args=[device]),
        ], scoped=True),
        OpaqueFunction(function=_mark_used_values),
    ])


def _declaration(row: LaunchArgument) -> DeclareLaunchArgument:
    return DeclareLaunchArgument(
        row.name, default_value=row.default, description=row.description,
        choices=['', *row.choices] if row.choices else None)


def _start(context: LaunchContext, device: str) -> list[LaunchDescriptionEntity]:
    values = {row.name: str(context.launch_configurations[row.name]) or row.default
              for row in ARGUMENTS}
    entities = [_driver(values, device)]
    if values['record']:
        entities.append(_recorder(values))
    if values['rviz'] == TRUE:
        entities.append(_rviz(values))
    return entities


def _driver(values: Mapping[str, str], device: str) -> Node:
    given = parameter_values(values)
    if device != DEFAULT:           # the launch file names it
        given.setdefault('sensor', device)
    level = values['log_level']
    return Node(
        package=PACKAGE, executable='driver_node', output='screen',
        name=values['name'], namespace=values['namespace'],
        respawn=values['respawn'] == TRUE, respawn_delay=RESPAWN_DELAY,
        ros_arguments=['--log-level', level] if level else None,
        parameters=[*_rules(_defaults(values)),
                    _params_file(values['params_file'], str(given.get('sensor', device))),
                    *_rules(given)])


def _defaults(values: Mapping[str, str]) -> dict[str, Value]:
    """Return the parameters whose default is another one in a launch file."""
    waiting: dict[str, Value] = {'startup.wait_for_subscribers': RECORDER_TIMEOUT}
    return {'publish.static_tf': True, **(waiting if values['record'] else {})}


def _rules(parameters: Mapping[str, Value]) -> Iterator[Parameter]:
    return (Parameter(name, value, value_type=type(value)) for name, value in parameters.items())


def _params_file(given: str, sensor: str) -> str | PathJoinSubstitution:
    """Return the given file, or that of the package for a sensor; FileNotFoundError."""
    return existing_file('params_file', given) if given else shared('config', f'{sensor}.yaml')


def existing_file(argument: str, given: str) -> str:
    """Return the path of a file that an argument names; FileNotFoundError."""
    file = Path(given).expanduser()
    if not file.is_file():          # launch_ros would continue without it
        raise FileNotFoundError(f'{argument}:={given} is not a file')
    return str(file)


def _recorder(values: Mapping[str, str]) -> Node:
    # Its namespace is that of the driver, which it selects.
    return Node(
        package=PACKAGE, executable='bahrs', output='screen', namespace=values['namespace'],
        arguments=['record', '--output', str(Path(values['record']).expanduser()),
                   '--node', values['name']])


def _rviz(values: Mapping[str, str]) -> Node:
    # Its topics are relative names.
    return Node(package='rviz2', executable='rviz2', output='screen',
                namespace=values['namespace'],
                arguments=['-d', shared('rviz', 'bahrs.rviz')])


def shared(*parts: str) -> PathJoinSubstitution:
    """Return the path of a file that the package installs, by its parts."""
    return PathJoinSubstitution([FindPackageShare(PACKAGE), *parts])


def _drop_used_values(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Remove the values for an earlier include from the scope."""
    return [_dropped(context, name) for name in _used_names(context)]


def _dropped(context: LaunchContext, name: str) -> LaunchDescriptionEntity:
    value = context.launch_configurations.pop(name)
    return LogInfo(msg=f'{name}:={value} was given to an earlier include of {PACKAGE} and is not '
                       'used here: give it to this one, too, if it is for both')


def _used_names(context: LaunchContext) -> Iterator[str]:
    values = context.launch_configurations
    return (row.name for row in ARGUMENTS if isinstance(values.get(row.name), UsedValue))


def _mark_used_values(context: LaunchContext) -> None:
    """Mark the values in the scope of the including file."""
    values = context.launch_configurations
    for row in ARGUMENTS:
        if row.name in values:
            values[row.name] = UsedValue(values[row.name])
