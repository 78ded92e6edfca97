# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of all nodes of this package with invalid environment variables."""

import contextlib
import time

from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from support.processes import running, wait_for

LONG = 120.0
ODD = st.one_of(st.sampled_from([
    '', ' ', '0', '-1', '900', '1e9', 'abc', '9' * 40, '\udcff', '\x1bc', '/', '/proc/x', '~',
    '\u0663', 'true', 'Enforce', 'rmw_nothing', 'rmw_fastrtps_cpp', '[', '{', ':=']),
    st.text(st.characters(blacklist_characters='\0'), max_size=8))
VARIABLES = ('ROS_DOMAIN_ID', 'RMW_IMPLEMENTATION', 'ROS_LOG_DIR', 'ROS_HOME', 'HOME',
             'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOCALHOST_ONLY', 'RCUTILS_COLORIZED_OUTPUT',
             'RCUTILS_LOGGING_USE_STDOUT', 'ROS_SECURITY_ENABLE',
             'ROS_SECURITY_STRATEGY', 'ROS_SECURITY_KEYSTORE', 'FASTDDS_BUILTIN_TRANSPORTS')
ROS_WORDS = st.lists(st.one_of(
    st.sampled_from(['-r', '-p', '--remap', '--param', '--params-file', '--log-level', '-e', '--',
                     '__ns:=/left', '__ns:=bad ns', '__node:=other', '__node:=a/b', 'x:=1',
                     'use_sim_time:=maybe', 'use_sim_time:=true', '/dev/null', '--nothing']),
    ODD), max_size=4).map(lambda words: ['--ros-args', *words])
# The monitor watches an empty namespace: the driver in this test publishes in the root.
NODES = {'driver_node': [], 'monitor': ['--node', '/elsewhere/absent', '--duration', '0.2'],
         'doctor': ['--no-listen', '--port', '/dev/null'], 'record': ['--raw-only', '-o']}
# What those print that do not end by themselves, once they have started.
STARTED = {'driver_node': 'does not exist', 'record': 'bahrs record: the'}


class Started:
    """All nodes of this package, run at once in the same environment."""

    def __init__(self, folder, for_ros=()):
        """Start all nodes, and end those that run after their start."""
        self.status, self.text = {}, {}
        with contextlib.ExitStack() as stack:
            nodes = {name: stack.enter_context(running(*words(name, folder), *for_ros))
                     for name in NODES}
            for name, process in nodes.items():
                assert wait_for(lambda: not process.alive or STARTED.get(name, 'Traceback')
                                in process.text, LONG), process.text
                self.status[name] = process.end()
                self.text[name] = process.text


def words(name, folder):
    """Return the command line of a node."""
    if name == 'driver_node':
        return [name]
    bag = [str(folder / f'bag{time.monotonic_ns()}')] if name == 'record' else []
    return ['bahrs', name, *NODES[name], *bag]


def has_no_traceback(started):
    """Assert that a program that did not start printed one sentence."""
    for name, text in started.text.items():
        assert 'Traceback' not in text and 'terminate called' not in text, text
        assert started.status[name] in (0, 1), (name, started.status[name], text)
        assert text or not started.status[name], name


@pytest.mark.parametrize('variables', [
    {'ROS_LOG_DIR': '/proc/nowhere'}, {'ROS_LOG_DIR': __file__}, {'ROS_HOME': '/dev/null'},
    {'HOME': ''}])
def test_without_log_files(tmp_path, monkeypatch, variables):
    """All nodes work, the driver warns, and the doctor names the variable to set."""
    for name in ('ROS_LOG_DIR', 'ROS_HOME'):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    started = Started(tmp_path)
    has_no_traceback(started)
    assert 'logs are not written to files' in started.text['driver_node']
    assert 'does not exist' in started.text['driver_node']      # of the port: it runs
    assert '-> export ROS_LOG_DIR=' in started.text['doctor']
    assert 'is driver_node running' in started.text['monitor']
    assert 'bahrs record: the' in started.text['record']


@pytest.mark.parametrize('name, value', [
    ('RMW_IMPLEMENTATION', 'rmw_nothing'), ('ROS_DOMAIN_ID', '900'),
    ('ROS_STATIC_PEERS', 'nowhere.invalid'), ('RCUTILS_COLORIZED_OUTPUT', 'yes')])
def test_variables_that_prevent_the_start_of_ros(tmp_path, monkeypatch, name, value):
    """Each node prints only an error that names the variable."""
    # The range of the tests would ignore static peers.
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'SUBNET')
    monkeypatch.setenv(name, value)
    started = Started(tmp_path)
    has_no_traceback(started)
    assert all(status == 1 for status in started.status.values()), started.status
    for node in ('driver_node', 'monitor', 'record'):
        (line,) = started.text[node].splitlines()
        assert name in line
    assert f'{name}' in started.text['doctor']


@pytest.mark.slow
@settings(max_examples=5, suppress_health_check=list(HealthCheck))
@given(variables=st.dictionaries(st.sampled_from(VARIABLES), ODD, min_size=1, max_size=3))
def test_any_environment(tmp_path, variables):
    """Each node starts, or prints the reason in one sentence."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)       # for log files at odd places
        for name, value in variables.items():
            patch.setenv(name, value)
        has_no_traceback(Started(tmp_path, []))


@pytest.mark.slow
@settings(max_examples=5, suppress_health_check=list(HealthCheck))
@given(for_ros=ROS_WORDS)
def test_any_ros_arguments(tmp_path, for_ros):
    """Each node starts, or prints the reason in one sentence."""
    words = [word for word in for_ros if '\0' not in word]
    has_no_traceback(Started(tmp_path, words))
