# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the checks of the ROS environment."""

from pathlib import Path

from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.ros_environment import check
import pytest

NOWHERE = Path('/nowhere')


@pytest.fixture
def prefix(tmp_path):
    """Return a prefix with this package and one middleware."""
    index = tmp_path / 'share/ament_index/resource_index'
    for name in ('packages/bahrs_driver', 'rmw_typesupport/rmw_fastrtps_cpp',
                 'rmw_typesupport/rmw_implementation'):
        (index / name).parent.mkdir(parents=True, exist_ok=True)
        (index / name).touch()
    return tmp_path


def found(prefix, has_rclpy=True, **variables):
    """Return the results by check."""
    environment = {'AMENT_PREFIX_PATH': str(prefix), 'ROS_DISTRO': 'jazzy', **variables}
    return {result.check: result for result in check(environment, has_rclpy, NOWHERE)}


def test_a_correct_environment(prefix):
    """No problem is reported."""
    results = found(prefix, ROS_DOMAIN_ID='7', ROS_LOG_DIR='/tmp',
                    RMW_IMPLEMENTATION='rmw_fastrtps_cpp')
    assert {result.level for result in results.values()} == {Level.OK}
    assert set(results) == {'ROS', 'package', 'middleware', 'domain', 'discovery',
                            'log files'}
    assert found(prefix)['middleware'].message == 'is the default (installed: rmw_fastrtps_cpp)'


def test_ros_is_not_sourced(prefix):
    """It is the only result."""
    results = found(prefix, has_rclpy=False)
    assert results['ROS'].command == 'source /opt/ros/jazzy/setup.bash'
    assert len(results) == 1


@pytest.mark.parametrize('check, level, command, variables', [
    ('ROS', Level.ADVICE, 'source /opt/ros/jazzy/setup.bash', {'ROS_DISTRO': 'humble'}),
    ('ROS', Level.PROBLEM, 'env -i HOME="$HOME" bash --rcfile /opt/ros/jazzy/setup.bash',
     {'AMENT_PREFIX_PATH': '/opt/ros/humble:/opt/ros/jazzy'}),
    ('package', Level.ADVICE, 'source install/setup.bash',
     {'AMENT_PREFIX_PATH': '/opt/ros/jazzy'}),
    ('middleware', Level.PROBLEM, 'sudo apt install ros-jazzy-rmw-cyclonedds-cpp',
     {'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp'}),
    ('domain', Level.PROBLEM, 'export ROS_DOMAIN_ID=0', {'ROS_DOMAIN_ID': '300'}),
    ('domain', Level.PROBLEM, 'export ROS_DOMAIN_ID=0', {'ROS_DOMAIN_ID': 'mine'}),
    ('discovery', Level.PROBLEM, 'unset ROS_AUTOMATIC_DISCOVERY_RANGE',
     {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF'}),
    ('discovery', Level.PROBLEM, 'unset ROS_AUTOMATIC_DISCOVERY_RANGE',
     {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'HERE'}),
])
def test_problems(prefix, check, level, command, variables):
    """Each has the command that corrects it."""
    result = found(prefix, **variables)[check]
    assert (result.level, result.command) == (level, command)


def test_a_deprecated_variable(prefix):
    """The result is advice."""
    environment = {'AMENT_PREFIX_PATH': str(prefix), 'ROS_LOCALHOST_ONLY': '1'}
    results = list(check(environment, True, NOWHERE))
    assert 'unset ROS_LOCALHOST_ONLY' in [result.command for result in results]


def test_ros_from_python_packages():
    """There is no prefix to check, and nothing to source."""
    results = {result.check: result for result in check({}, True, NOWHERE)}
    assert results['ROS'].level is Level.OK and '/nowhere' in results['ROS'].message
    assert 'package' not in results
