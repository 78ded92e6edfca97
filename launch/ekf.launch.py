# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Start a BAHRS and the filter of robot_localization, optionally with a Titan-M.

    ros2 launch bahrs_driver ekf.launch.py port:=/dev/ttyUSB0
    ros2 launch bahrs_driver ekf.launch.py port:=/dev/ttyUSB0 titan_m_port:=/dev/ttyUSB1 x:=0.1

All arguments of bahrs.launch.py are for the BAHRS. Whatever the parameter files of the drivers
say, incomplete vectors are not reported and the filter alone publishes odom to base_link.
"""

from ament_index_python.packages import get_package_prefix, PackageNotFoundError
from bahrs_driver.node.launching import existing_file, shared
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node

FILTER = 'robot_localization'
TITAN_M = 'titan_m'             # its namespace
ARGUMENTS = {
    'namespace': 'namespace of all nodes and topics',
    'titan_m_port': 'serial port of a Titan-M (default: none, the BAHRS is alone)',
    'titan_m_params_file': 'parameter file of the Titan-M, with its mounting',
    'ekf_params_file': 'parameter file of the filter (default: config/ekf.yaml of this package, '
                       'or config/ekf_titan_m.yaml with a Titan-M)',
}


def generate_launch_description() -> LaunchDescription:
    """Return the drivers and the filter."""
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value='', description=text)
          for name, text in ARGUMENTS.items()),
        OpaqueFunction(function=_start)])


def _start(context: LaunchContext) -> list[LaunchDescriptionEntity]:
    _check_installation()
    namespace, port, titan_m_file, filter_file = (
        str(context.launch_configurations[name])
        for name in ('namespace', 'titan_m_port', 'titan_m_params_file', 'ekf_params_file'))
    file = existing_file('ekf_params_file', filter_file) if filter_file \
        else shared('config', f'ekf_{TITAN_M}.yaml' if port else 'ekf.yaml')
    entities = [_driver('bahrs', {'namespace': namespace}),
                _node('ekf_node', 'ekf_filter_node', namespace, file)]
    if port:
        entities += [
            _driver('titan_m', {
                'port': port, 'namespace': f'{namespace}/{TITAN_M}',
                'frame_id': 'titan_m_link', 'params_file': titan_m_file}),
            _node('navsat_transform_node', 'navsat_transform_node', namespace, file)]
    return entities


def _check_installation() -> None:
    """Raise RuntimeError if there is no filter."""
    try:
        get_package_prefix(FILTER)
    except PackageNotFoundError as error:
        raise RuntimeError(f'{FILTER} is not installed: sudo apt install '
                           'ros-$ROS_DISTRO-robot-localization') from error


def _driver(device: str, arguments: dict[str, str]) -> IncludeLaunchDescription:
    return IncludeLaunchDescription(
        shared('launch', f'{device}.launch.py'),
        launch_arguments={**arguments, 'publish_tf': 'false',
                          'publish_incomplete': 'not_reported'}.items())


def _node(executable: str, name: str, namespace: str, file: str | PathJoinSubstitution) -> Node:
    return Node(package=FILTER, executable=executable, name=name, namespace=namespace,
                output='screen', parameters=[file],
                remappings=[('gps/fix', f'{TITAN_M}/fix')])
