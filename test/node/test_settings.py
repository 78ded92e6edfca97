# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Settings of the node as a process: which are used, and that they can be asked for and set."""

import contextlib
from pathlib import Path
import shlex

from bahrs_driver.convert.bahrs.converter import TOPICS
import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from support.devices import call, Device
from support.processes import command, listening, Process, running
from support.starting import start

CONFIG = Path(__file__).resolve().parents[2] / 'config'
UNDEFINED = 200


@contextlib.contextmanager
def process(*words):
    """Run any command, and end it afterwards."""
    child = Process(list(words))
    try:
        yield child
    finally:
        child.end()


def text_of(ear, node, name):
    """Return the value of a parameter that is a text."""
    response = call(ear, GetParameters, f'{node}/get_parameters',
                    GetParameters.Request(names=[name]))
    return response.values[0].string_value


@pytest.mark.parametrize('name', ['bahrs', 'titan_m'])
def test_the_shipped_file_is_for_a_node_of_any_name(tmp_path, name):
    """In a namespace, too; a rule on the command line overrides it."""
    with listening({}) as ear, running(
            'driver_node', '--ros-args', '--params-file', str(CONFIG / f'{name}.yaml'),
            '-p', f'port:={tmp_path}/port', '-r', '__node:=front', '-r', '__ns:=/left') as node:
        assert text_of(ear, '/left/front', 'sensor') == name
        assert text_of(ear, '/left/front', 'port') == f'{tmp_path}/port'
        assert 'without effect' not in node.text


def test_a_rule_beats_a_file_that_names_the_node(tmp_path):
    """Although rcl prefers values for the name of the node."""
    file = tmp_path / 'my.yaml'
    file.write_text('/bahrs_driver:\n  ros__parameters:\n    port: /dev/ttyUSB7\n')
    with listening({}) as ear, running(
            'driver_node', '--ros-args', '--params-file', str(CONFIG / 'bahrs.yaml'),
            '--params-file', str(file), '-p', f'port:={tmp_path}/port'):
        assert text_of(ear, '/bahrs_driver', 'port') == f'{tmp_path}/port'


def test_frames_are_published_without_a_leading_slash(cable):
    """With one warning."""
    with listening(TOPICS) as ear, running(
            'driver_node', '--ros-args', '-p', f'port:={cable.path}', '-p', 'frame_id:=/imu',
            '-p', 'world_frame_id:=/left/map') as node, Device(cable):
        assert ear.wait('imu/data')[-1].header.frame_id == 'imu'
        assert ear.wait('velocity')[-1].header.frame_id == 'left/map'
        assert "parameter frame_id is '/imu': names of frames have no leading slash, 'imu' is " \
            'used' in node.text


def test_requests_that_cannot_be_met_are_answered_and_disturb_nothing(cable):
    """An undefined type is refused like any other invalid value, and data continues."""
    items = [Parameter(name='port', value=ParameterValue(type=UNDEFINED)),
             Parameter(name='nvm.page', value=ParameterValue(type=UNDEFINED)),
             Parameter(name='frame_id', value=ParameterValue(type=4, string_value='x')),
             Parameter(name='nvm.page', value=ParameterValue(type=2, integer_value=3))]
    with listening(TOPICS) as ear, running(
            'driver_node', '--ros-args', '-p', f'port:={cable.path}') as node, Device(cable):
        ear.wait('imu/data')
        results = call(ear, SetParameters, 'bahrs_driver/set_parameters',
                       SetParameters.Request(parameters=items)).results
        assert [result.successful for result in results] == [False, False, False, True]
        assert 'cannot have a value of type 200' in results[1].reason
        assert results[2].reason == ('parameter frame_id is read when the driver starts: restart '
                                     'it with -p frame_id:=VALUE')
        ear.wait('imu/data', len(ear.messages['imu/data']) + 50)
        assert 'Traceback' not in node.text and node.end() == 0


@pytest.mark.parametrize('words', [
    ['-p', 'port:=\udcff'], ['-p', 'sensor:=[]'], ['-p', 'baud_rate:={}'], ['-p', 'frame_id:= '],
    ['-p', 'stddev.velocity:=99999999999999999999999'], ['-p', 'use_sim_time:=[]'],
    ['-p', 'qos_overrides./raw.publisher.depth:=-1', '-p', 'publish.raw:=true'],
    ['--params-file', '/dev/urandom'], ['--params-file', '/'], ['-r', '__node:=a b'],
    ['--params-file', str(CONFIG / 'foxglove_layout.json')]], ids=repr)
def test_what_cannot_be_used_ends_the_start_with_one_sentence(monkeypatch, capfd, words):
    """With status 1 and no traceback, for errors of any library."""
    started = start(monkeypatch, capfd, *words)
    assert started.status == 1
    sentences = [line for line in started.lines if line.startswith('bahrs_driver: ')]
    assert len(sentences) == 1
    assert 'Traceback' not in started.text and '.py' not in started.text


def test_a_parameter_file_may_be_a_pipe(tmp_path):
    """As from a shell for <(command): it can be read only once."""
    content = f'/**: {{ros__parameters: {{port: {tmp_path}/port, sensor: titan_m}}}}'
    command_line = shlex.join(command('driver_node', '--ros-args', '--params-file'))
    with listening({}) as ear, process(
            'bash', '-c', f'exec {command_line} <(echo {shlex.quote(content)})') as node:
        assert text_of(ear, '/bahrs_driver', 'sensor') == 'titan_m'
        assert 'without effect' not in node.text


def test_a_change_that_nothing_would_read_is_refused(cable):
    """The reason is in the response, for parameters of ROS, too."""
    items = [Parameter(name='use_sim_time', value=ParameterValue(type=1, bool_value=True)),
             Parameter(name='qos_overrides./imu/data.publisher.depth',
                       value=ParameterValue(type=2, integer_value=5)),
             Parameter(name='gps.week', value=ParameterValue(type=2, integer_value=2400))]
    with listening({}) as ear, running(
            'driver_node', '--ros-args', '-p', f'port:={cable.path}',
            '-p', 'qos_overrides./imu/data.publisher.depth:=7'):
        results = call(ear, SetParameters, 'bahrs_driver/set_parameters',
                       SetParameters.Request(parameters=items)).results
        assert not any(result.successful for result in results)
        assert 'use_sim_time cannot be changed' in results[0].reason
        assert 'read-only' in results[1].reason
        assert results[2].reason == 'parameter gps.week has no effect: sensor is bahrs'
