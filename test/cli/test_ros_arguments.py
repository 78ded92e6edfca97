# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of verbs that a launch file starts with --ros-args."""

from bahrs_driver.cli.main import ROS_NODES, VERBS
from bahrs_driver.cli.ros_arguments import namespace
from bahrs_driver.settings.command_line import split_arguments
from hypothesis import given, strategies as st
import pytest
from rclpy.utilities import remove_ros_args
from support.processes import running

LAUNCHED = ['--ros-args', '-r', '__node:=launched', '-r', '__ns:=/left', '-p', 'x:=1']


@pytest.mark.parametrize('words, own, for_ros', [
    ([], [], []),
    (['-o', 'x'], ['-o', 'x'], []),
    (['-o', 'x', '--ros-args'], ['-o', 'x'], ['--ros-args']),
    (['a', '--ros-args', '-r', 'b:=c', '--', 'd'], ['a', 'd'],
     ['--ros-args', '-r', 'b:=c', '--']),
    (['--', '-x', '--ros-args', '-p', 'y:=1'], ['--', '-x'], ['--ros-args', '-p', 'y:=1']),
])
def test_split_arguments(words, own, for_ros):
    """The result is that of rcl."""
    assert split_arguments(words) == (own, for_ros)


@given(st.lists(st.sampled_from(['--ros-args', '--', 'file', '--json', '--enable-rosout-logs'])))
def test_split_arguments_as_rclpy(words):
    """This holds for any position of the marks."""
    try:
        left = remove_ros_args(['bahrs', *words])
    except Exception:           # rclpy parses what is for ROS, too
        return
    assert split_arguments(words)[0] == left[1:]


@pytest.mark.parametrize('words, found', [
    ([], None),
    (['--ros-args', '-r', '__ns:=/left'], '/left'),
    (['--ros-args', '--remap', 'bahrs:__ns:=/left'], '/left'),
    (['--ros-args', '-r', '__ns:=/left', '-r', '__ns:=/right'], '/right'),
    (['--ros-args', '-r', '__node:=x', '-p', '__ns:=/no', '-r'], None),
])
def test_namespace_rule(words, found):
    """It is the namespace that the node gets."""
    assert namespace(words) == found


def test_a_verb_that_is_a_node():
    """It uses the ROS arguments."""
    with running('bahrs', 'monitor', '--duration', '0.5', '--json', *LAUNCHED) as monitor:
        assert monitor.wait() == 1          # there is no driver
        assert monitor.text.startswith('{"heard": false'), monitor.text


def test_a_verb_that_is_no_node(tmp_path):
    """It works, and reports that the ROS arguments have no effect."""
    with running('bahrs', 'emulate', '--output', str(tmp_path / 'x.bin'), '--duration', '1',
                 *LAUNCHED) as emulator:
        assert emulator.wait() == 0
        assert emulator.text.startswith('bahrs emulate: --ros-args -r __node:=launched')
        assert 'no effect' in emulator.text
    assert set(ROS_NODES) < set(VERBS)
