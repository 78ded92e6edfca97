# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test the checks before ROS is started, and the sentences about its errors."""

import os
import subprocess
import sys

from bahrs_driver.errors import RosStartError
from bahrs_driver.ros.environment import log_directory, log_problem
from bahrs_driver.ros.start import check_environment, check_import
from bahrs_driver.ros.start_errors import start_errors
from hypothesis import given, strategies as st
import pytest

TEXTS = st.text(st.characters(blacklist_characters='\0'), max_size=30)


@pytest.mark.parametrize('variables', [
    {}, {'ROS_DOMAIN_ID': ''}, {'ROS_DOMAIN_ID': '0'}, {'ROS_DOMAIN_ID': '232'},
    {'RMW_IMPLEMENTATION': ''}, {'RCUTILS_COLORIZED_OUTPUT': '1'}])
def test_what_ros_can_start_with(variables):
    """No error."""
    check_environment(variables)


@pytest.mark.parametrize('name, value', [
    ('ROS_DOMAIN_ID', '233'), ('ROS_DOMAIN_ID', '-1'), ('ROS_DOMAIN_ID', '9' * 30),
    ('ROS_DOMAIN_ID', 'abc'), ('ROS_DOMAIN_ID', '\u0663'), ('ROS_DOMAIN_ID', '\udcff'),
    ('RMW_IMPLEMENTATION', 'rmw_nothing'), ('RMW_IMPLEMENTATION', '\x1bc'),
    ('RCUTILS_COLORIZED_OUTPUT', 'yes'), ('RCUTILS_LOGGING_USE_STDOUT', '2'),
    ('RCUTILS_LOGGING_BUFFERED_STREAM', 'x')])
def test_what_ros_would_end_the_process_for(name, value):
    """The variable is named, and what it may be."""
    environment = {name: value, 'AMENT_PREFIX_PATH': prefix_of_ros()}
    with pytest.raises(RosStartError, match=f'^{name} is ') as caught:
        check_environment(environment)
    assert str(caught.value).isprintable()


def prefix_of_ros():
    """Return the prefixes below which ROS is installed."""
    return os.environ.get('AMENT_PREFIX_PATH') or sys.prefix


def test_without_an_index_any_middleware_may_be_there(tmp_path):
    """It cannot be known."""
    check_import({'RMW_IMPLEMENTATION': 'rmw_x', 'AMENT_PREFIX_PATH': str(tmp_path)})


@given(st.dictionaries(st.sampled_from(
    ['ROS_DOMAIN_ID', 'RMW_IMPLEMENTATION', 'RCUTILS_COLORIZED_OUTPUT', 'AMENT_PREFIX_PATH',
     'ROS_LOG_DIR', 'ROS_HOME', 'HOME']), TEXTS))
def test_any_environment(variables):
    """Looked at without any other error, and explained in printable words."""
    try:
        check_environment(variables)
    except RosStartError as error:
        assert str(error).isprintable()
    assert log_problem(variables).isprintable()


def test_log_directory():
    """In the order of rcl: ROS_LOG_DIR, ROS_HOME, home."""
    assert log_directory({'ROS_LOG_DIR': '/a', 'ROS_HOME': '/b', 'HOME': '/c'}) == '/a'
    assert log_directory({'ROS_LOG_DIR': '', 'ROS_HOME': '/b', 'HOME': '/c'}) == '/b/log'
    assert log_directory({'HOME': '/c'}) == '/c/.ros/log'
    assert log_directory({'ROS_LOG_DIR': '~/x', 'HOME': '/c'}) == '/c/x'


def test_a_log_directory_that_can_be_made(tmp_path):
    """It is not made yet."""
    assert log_problem({'ROS_LOG_DIR': f'{tmp_path}/a/b'}) == ''
    assert not (tmp_path / 'a').exists()


def test_log_directories_that_cannot_be_made(tmp_path):
    """Each with its reason."""
    (tmp_path / 'file').touch()
    assert 'needs HOME' in log_problem({})
    assert 'is no directory' in log_problem({'ROS_LOG_DIR': f'{tmp_path}/file'})
    assert 'is no directory' in log_problem({'ROS_HOME': f'{tmp_path}/file'})
    assert 'cannot be used' in log_problem({'ROS_LOG_DIR': f"{tmp_path}/{'a' * 300}"})
    assert 'cannot be written' in log_problem({'ROS_LOG_DIR': '/proc/nowhere'})


@pytest.mark.skipif(os.geteuid() == 0, reason='root may write everywhere')
def test_a_log_directory_that_is_locked(tmp_path):
    """The reason is the system's."""
    tmp_path.chmod(0o500)
    assert 'cannot be written: Permission denied' in log_problem({'ROS_LOG_DIR': f'{tmp_path}/x'})


@given(st.sampled_from([RuntimeError, OSError, ValueError, KeyError, ZeroDivisionError]), TEXTS)
def test_any_exception_becomes_one_sentence(kind, text):
    """Any exception is explained, except Ctrl-C."""
    with pytest.raises(RosStartError) as caught, start_errors([]):
        raise kind(text)
    assert str(caught.value).isprintable() and 0 < len(str(caught.value)) < 600
    with pytest.raises(KeyboardInterrupt), start_errors([]):
        raise KeyboardInterrupt


def test_importing_it_imports_no_ros():
    """Or its checks would come too late."""
    code = 'import sys, bahrs_driver.ros.start; sys.exit("rclpy" in sys.modules)'
    assert subprocess.run([sys.executable, '-c', code], check=False).returncode == 0
