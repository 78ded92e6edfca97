# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The launch description of one driver node and its launch arguments.

A value of the node comes from a given argument, else from the parameter file, else it is the
default of the driver: an omitted argument passes nothing on.

Launch keeps arguments in the scope of the including file, where the next included file finds them.
So the description has a scope of its own, and marks a value that an earlier include of this
package has used: a later include ignores it. For other files it does not change. A namespace for
several drivers is given to each include.
"""

from collections.abc import Iterator
from pathlib import Path

from bahrs_driver.devices.registry import DEFAULT, DEVICES
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from launch.actions import DeclareLaunchArgument, GroupAction, LogInfo, OpaqueFunction
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.descriptions import Parameter
from launch_ros.substitutions import FindPackageShare

PACKAGE = 'bahrs_driver'
ARGUMENTS = ('port', 'name', 'namespace', 'params_file')


class UsedValue(str):
    """The value of an argument that was given to an earlier include of this package."""


def describe_driver(launch_file: str) -> LaunchDescription:
    """Describe a driver for the device that the launch file DEVICE.launch.py is named after."""
    device = DEVICES[Path(launch_file).name.partition('.')[0]].name
    config = f'{device}.yaml'
    share = FindPackageShare(PACKAGE)
    return LaunchDescription([
        GroupAction([
            OpaqueFunction(function=_drop_used_values),
            DeclareLaunchArgument(
                'port', default_value='',
                description='serial port: a path or URL (default: as params_file '
                            'says, or /dev/ttyUSB0)'),
            DeclareLaunchArgument('name', default_value=PACKAGE, description='name of the node'),
            DeclareLaunchArgument('namespace', default_value='',
                                  description='namespace of the node and its topics'),
            DeclareLaunchArgument(
                'params_file', default_value=PathJoinSubstitution([share, 'config', config]),
                description='parameter file, with a key for the node, such as /**'),
            OpaqueFunction(function=_start_node, args=['' if device == DEFAULT else device]),
        ], scoped=True),
        OpaqueFunction(function=_mark_used_values),
    ])


def _start_node(context: LaunchContext, sensor: str) -> list[LaunchDescriptionEntity]:
    values = {name: str(context.launch_configurations[name]) for name in ARGUMENTS}
    file = Path(values['params_file']).expanduser()
    if not file.is_file():          # launch_ros would continue without it
        raise FileNotFoundError(f"params_file:={values['params_file']} is not a file")
    given = {'sensor': sensor, 'port': values['port']}
    return [Node(
        package=PACKAGE, executable='driver_node', output='screen',
        name=values['name'], namespace=values['namespace'],
        # Rules on the command line override the file, for any node name in it.
        parameters=[str(file),
                    *(Parameter(name, value, value_type=str)
                      for name, value in given.items() if value)])]


def _drop_used_values(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    """Remove the values for an earlier include from the scope."""
    return [_dropped(context, name) for name in _used_names(context)]


def _dropped(context: LaunchContext, name: str) -> LaunchDescriptionEntity:
    value = context.launch_configurations.pop(name)
    return LogInfo(msg=f'{name}:={value} was given to an earlier include of {PACKAGE} and is not '
                       'used here: give it to this one, too, if it is for both')


def _used_names(context: LaunchContext) -> Iterator[str]:
    values = context.launch_configurations
    return (name for name in ARGUMENTS if isinstance(values.get(name), UsedValue))


def _mark_used_values(context: LaunchContext) -> None:
    """Mark the values in the scope of the including file."""
    values = context.launch_configurations
    for name in ARGUMENTS:
        if name in values:
            values[name] = UsedValue(values[name])
