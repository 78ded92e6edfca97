# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the launch files: arguments override the file, the file overrides defaults."""

import importlib.util
from itertools import pairwise
import os
from pathlib import Path

from bahrs_driver.cli.main import _parser
from bahrs_driver.cli.node_options import selected_node
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.node.launch_arguments import ARGUMENTS
from bahrs_driver.settings.command_line import RosArguments
from hypothesis import given, strategies as st
import pytest
from support.launch_stand_in import Command
from support.launched import install_filter, StandIn
from support.node_settings import node_settings

ROOT = Path(__file__).resolve().parents[2]
FILES = tuple(DEVICES)
BOTH = 'two_devices'
PREFIXES = 'AMENT_PREFIX_PATH'


class Real:
    """Runs launch files with launch, and starts the processes for a moment."""

    def __init__(self):
        """Import launch."""
        from launch import actions, LaunchDescription, LaunchService
        from launch.event_handlers import OnProcessStart
        from launch.launch_description_sources import PythonLaunchDescriptionSource
        self._actions, self._source = actions, PythonLaunchDescriptionSource
        self._description, self._service = LaunchDescription, LaunchService
        self._on_start = OnProcessStart
        self.set_argument = actions.SetLaunchConfiguration

    def include(self, file, arguments):
        """Return an action that includes a file with arguments."""
        return self._actions.IncludeLaunchDescription(
            self._source(str(ROOT / 'launch' / f'{file}.launch.py')),
            launch_arguments=arguments.items())

    def run(self, *entities, count=1):
        """Return the commands that are started, which are count, and the context at the end."""
        commands = []

        def started(event, context):
            commands.append(Command(Path(event.cmd[0]).name, event.cmd[1:]))
            return [self._actions.Shutdown()] if len(commands) == count else []

        service = self._service(noninteractive=True)
        service.include_launch_description(self._description([
            self._actions.RegisterEventHandler(self._on_start(on_start=started)), *entities]))
        service.run()
        return commands, service.context


@pytest.fixture(params=[StandIn, Real], ids=['stand-in', 'real'])
def launch(request):
    """Return what runs launch files: the stand-in, and launch if installed."""
    if request.param is Real and not importlib.util.find_spec('launch_ros'):
        pytest.skip('launch_ros is not installed: only its stand-in is tried')
    return request.param()


def of_node(command):
    """Return name, namespace and parameter files of a node, and the rules after the files."""
    assert command.executable == 'driver_node'
    remaps = dict(word.split(':=') for word in command.words if word.startswith('__'))
    arguments = RosArguments.from_words(command.words)
    return (remaps['__node'], remaps['__ns'], [Path(file).name for file in arguments.files],
            dict(map(name_and_text, arguments.last_rules.values())))


def name_and_text(rule):
    """Return name and value of a rule; YAML marks the end of a value in a line of its own."""
    name, value = rule.split(':=')
    return name, value.splitlines()[0]


def defaults(command):
    """Return the rules that a parameter file overrides."""
    words = command.words[:command.words.index('--params-file')]
    return dict(map(name_and_text, RosArguments.from_words(words).rules))


def test_no_arguments(launch):
    """The name is that of the package; only a device other than the default is passed on."""
    commands, _ = launch.run(launch.include('bahrs', {}), launch.include('titan_m', {}), count=2)
    assert [of_node(command) for command in commands] == [
        ('bahrs_driver', '/', ['bahrs.yaml'], {}),
        ('bahrs_driver', '/', ['titan_m.yaml'], {'sensor': 'titan_m'})]
    assert all(defaults(command) == {'publish.static_tf': 'true'} for command in commands)


def test_all_arguments_of_the_driver(launch, tmp_path):
    """A port that looks like a number stays a text, and a whole number becomes a decimal one."""
    file = tmp_path / 'my.yaml'
    file.touch()
    (command,), _ = launch.run(launch.include('bahrs', {
        'port': '4001', 'name': 'front', 'namespace': 'left', 'params_file': str(file),
        'sensor': 'titan_m', 'frame_id': 'imu', 'publish_static_tf': 'false',
        'publish_tf': 'true', 'x': '1', 'y': '-0.5', 'z': '2e-2', 'roll': '0', 'pitch': '0.1',
        'yaw': '3.14', 'log_level': 'debug'}))
    assert of_node(command) == ('front', '/left', ['my.yaml'], {
        'port': "'4001'", 'sensor': 'titan_m', 'frame_id': 'imu', 'publish.static_tf': 'false',
        'publish.tf': 'true', 'mounting.x': '1.0', 'mounting.y': '-0.5', 'mounting.z': '0.02',
        'mounting.roll': '0.0', 'mounting.pitch': '0.1', 'mounting.yaw': '3.14'})
    level = command.words.index('--log-level')
    assert command.words[level - 1:level + 2] == ['--ros-args', '--log-level', 'debug']


@pytest.mark.parametrize('file, sensor', [('bahrs', 'titan_m'), ('titan_m', 'bahrs')])
def test_the_sensor_chooses_the_parameter_file(launch, file, sensor):
    """The argument beats the name of the launch file."""
    (command,), _ = launch.run(launch.include(file, {'sensor': sensor}))
    assert of_node(command)[2:] == ([f'{sensor}.yaml'], {'sensor': sensor})


def test_empty_arguments_are_not_given(launch):
    """So a launch file passes its own arguments on, given or not."""
    (command,), _ = launch.run(launch.include('bahrs', {row.name: '' for row in ARGUMENTS}))
    assert of_node(command) == ('bahrs_driver', '/', ['bahrs.yaml'], {})


def test_record(launch, tmp_path):
    """The recorder selects the driver by name and namespace; the driver waits for it."""
    commands, _ = launch.run(launch.include('bahrs', {
        'record': str(tmp_path / 'flight'), 'name': 'front', 'namespace': 'left'}), count=2)
    driver, recorder = sorted(commands, key=lambda command: command.executable, reverse=True)
    assert (recorder.executable, recorder.words) == ('bahrs', [
        'record', '--output', str(tmp_path / 'flight'), '--node', 'front',
        '--ros-args', '-r', '__ns:=/left'])
    assert defaults(driver) == {'publish.static_tf': 'true',
                                'startup.wait_for_subscribers': '10.0'}
    options = _parser('record').parse_args(recorder.words[:5])
    options.ros_arguments = recorder.words[5:]
    assert selected_node(options).exact == '/left/front'


def test_rviz():
    """It resolves relative topics in the namespace of the driver."""
    commands, _ = StandIn().run(StandIn().include('bahrs', {'rviz': 'true', 'namespace': 'left'}))
    assert commands[1] == ('rviz2', [
        '-d', str(ROOT / 'rviz' / 'bahrs.rviz'), '--ros-args', '-r', '__ns:=/left'], False)


def test_respawn():
    """The driver only: a recorder would find its directory there."""
    commands, _ = StandIn().run(StandIn().include('bahrs', {'respawn': 'true', 'record': 'x'}))
    assert [(command.executable, command.respawn) for command in commands] == [
        ('driver_node', True), ('bahrs', False)]


@pytest.mark.parametrize('arguments, error', [
    ({'x': 'ahead'}, "launch argument x: 'ahead' is not a number"),
    ({'sensor': 'gps'}, '"sensor" provided value "gps" is not valid'),
    ({'respawn': 'yes'}, '"respawn" provided value "yes" is not valid')])
def test_a_value_that_is_not_valid(arguments, error):
    """The message names the argument."""
    with pytest.raises((ValueError, RuntimeError), match=error):
        StandIn().run(StandIn().include('bahrs', arguments))


def test_two_devices(launch):
    """Each has a namespace, a frame and a position."""
    commands, _ = launch.run(
        launch.include(BOTH, {'bahrs_port': '/dev/b', 'titan_m_port': '/dev/t'}), count=2)
    assert [of_node(command) for command in commands] == [
        ('bahrs_driver', '/bahrs', ['bahrs.yaml'],
         {'port': '/dev/b', 'frame_id': 'bahrs_link', 'mounting.x': '0.1'}),
        ('bahrs_driver', '/titan_m', ['titan_m.yaml'],
         {'port': '/dev/t', 'frame_id': 'titan_m_link', 'mounting.x': '-0.1',
          'sensor': 'titan_m'})]


def test_two_devices_need_two_ports():
    """The default port would be the same for both."""
    with pytest.raises(RuntimeError, match='"bahrs_port" was not provided'):
        StandIn().run(StandIn().include(BOTH, {}))


@pytest.fixture
def with_filter(tmp_path, monkeypatch):
    """Install a package with the nodes of robot_localization, which do nothing."""
    monkeypatch.setenv(PREFIXES, f'{install_filter(tmp_path)}:{os.environ.get(PREFIXES, "")}')


def of_filter(command):
    """Return executable, name, namespace, parameter files and remapped topics of a node."""
    rules = [word for word in command.words if ':=' in word]
    remaps = dict(rule.split(':=') for rule in rules)
    files = [Path(after).name for word, after in pairwise(command.words)
             if word == '--params-file']
    return command.executable, remaps['__node'], remaps['__ns'], files, remaps['gps/fix']


def by_executable(commands):
    """Return the commands of the drivers, and the others by their executables."""
    return ([command for command in commands if command.executable == 'driver_node'],
            {command.executable: of_filter(command) for command in commands
             if command.executable != 'driver_node'})


FOR_FILTER = {'publish.tf': 'false', 'publish.incomplete': 'not_reported'}


def test_filter_with_a_bahrs(launch, with_filter):
    """It gets the parameters for a BAHRS alone; arguments of the driver reach the driver."""
    commands, _ = launch.run(launch.include('ekf', {
        'port': '/dev/b', 'namespace': 'left', 'x': '0.5', 'publish_tf': 'true'}), count=2)
    (driver,), others = by_executable(commands)
    assert of_node(driver) == ('bahrs_driver', '/left', ['bahrs.yaml'], {
        'port': '/dev/b', 'mounting.x': '0.5', **FOR_FILTER})
    assert others == {'ekf_node': (
        'ekf_node', 'ekf_filter_node', '/left', ['ekf.yaml'], 'titan_m/fix')}


def test_filter_with_both_devices(launch, with_filter, tmp_path):
    """The Titan-M has a namespace and a frame of its own, and none of the BAHRS's arguments."""
    file = tmp_path / 'my.yaml'
    file.touch()
    commands, _ = launch.run(launch.include('ekf', {
        'port': '/dev/b', 'titan_m_port': '/dev/t', 'x': '0.5',
        'titan_m_params_file': str(file)}), count=4)
    drivers, others = by_executable(commands)
    assert sorted(map(of_node, drivers), key=lambda node: node[1]) == [
        ('bahrs_driver', '/', ['bahrs.yaml'], {
            'port': '/dev/b', 'mounting.x': '0.5', **FOR_FILTER}),
        ('bahrs_driver', '/titan_m', ['my.yaml'], {
            'port': '/dev/t', 'frame_id': 'titan_m_link', 'sensor': 'titan_m', **FOR_FILTER})]
    assert others == {executable: (executable, name, '/', ['ekf_titan_m.yaml'], 'titan_m/fix')
                      for executable, name in (
                          ('ekf_node', 'ekf_filter_node'),
                          ('navsat_transform_node', 'navsat_transform_node'))}


def test_another_file_for_the_filter(with_filter, tmp_path):
    """Launch itself would start it without any inputs if there is no such file."""
    launch, file = StandIn(), tmp_path / 'mine.yaml'
    arguments = {'ekf_params_file': str(file)}
    with pytest.raises(FileNotFoundError, match=f'ekf_params_file:={file} is not a file'):
        launch.run(launch.include('ekf', arguments))
    file.touch()
    commands, _ = launch.run(launch.include('ekf', arguments))
    assert by_executable(commands)[1]['ekf_node'][3] == ['mine.yaml']


def test_without_the_filter(tmp_path, monkeypatch):
    """The message names the command that installs it; no driver is started before."""
    monkeypatch.setenv(PREFIXES, str(tmp_path))
    with pytest.raises(RuntimeError, match='not installed: sudo apt install ros-.*-localization'):
        StandIn().run(StandIn().include('ekf', {}))


def test_two_includes(launch, tmp_path):
    """Arguments of one include do not reach the next, but stay in the scope of the includer."""
    file = tmp_path / 'my.yaml'
    file.touch()
    first = {'port': '/dev/b', 'name': 'front', 'namespace': 'left', 'params_file': str(file)}
    commands, context = launch.run(launch.include('bahrs', first),
                                   launch.include('titan_m', {'port': '/dev/t'}), count=2)
    assert [of_node(command) for command in commands] == [
        ('front', '/left', ['my.yaml'], {'port': '/dev/b'}),
        ('bahrs_driver', '/', ['titan_m.yaml'], {'sensor': 'titan_m', 'port': '/dev/t'})]
    assert context.launch_configurations == {**first, 'port': '/dev/t'}


def test_the_same_namespace_for_both(launch):
    """Each include gets it."""
    commands, _ = launch.run(
        launch.include('titan_m', {'namespace': 'left', 'name': 'a'}),
        launch.include('bahrs', {'namespace': 'left', 'name': 'b'}), count=2)
    assert [of_node(command)[:2] for command in commands] == [('a', '/left'), ('b', '/left')]


def test_an_argument_of_the_includer(launch):
    """The first include gets it, as with any launch file; later includes need their own."""
    commands, context = launch.run(
        launch.set_argument('namespace', 'left'),
        launch.include('bahrs', {}), launch.include('bahrs', {}), count=2)
    assert [of_node(command)[1] for command in commands] == ['/left', '/']
    assert context.launch_configurations == {'namespace': 'left'}


def test_a_parameter_file_that_does_not_exist():
    """Launch itself would warn, and start the driver without it."""
    launch = StandIn()
    with pytest.raises(FileNotFoundError, match='params_file:=/no/such.yaml is not a file'):
        launch.run(launch.include('bahrs', {'params_file': '/no/such.yaml'}))


def test_dropped_arguments_are_logged():
    """The log tells how to pass it to both."""
    launch = StandIn()
    _, context = launch.run(launch.include('bahrs', {'namespace': 'left'}),
                            launch.include('titan_m', {}))
    assert context.log == [
        'namespace:=left was given to an earlier include of bahrs_driver and is not used here: '
        'give it to this one, too, if it is for both']


TEXTS = {'port': ['/dev/a', 'socket://host:1', '4001', 'true', "it's: [x] #"],
         'name': ['front', 'bahrs_driver'],
         'namespace': ['left', '/right/inner', ''],
         'params_file': [str(ROOT / 'config' / f'{name}.yaml') for name in FILES],
         'frame_id': ['imu', '1'],
         'record': ['flight', 'a b']}
VALUES = {row.name: st.sampled_from(row.choices or TEXTS.get(row.name, ['0.5', '-1']))
          for row in ARGUMENTS}
INCLUDES = st.tuples(st.sampled_from(FILES), st.fixed_dictionaries({}, optional=VALUES))


@given(includes=st.lists(INCLUDES, min_size=1, max_size=4))
def test_includes_are_independent(includes):
    """Earlier includes have no effect."""
    launch = StandIn()
    together, _ = launch.run(*(launch.include(*include) for include in includes))
    assert together == [command for include in includes
                        for command in launch.run(launch.include(*include))[0]]


KEYS = ['/**', '/*', 'bahrs_driver', '/bahrs_driver', '/**/bahrs_driver', '/**/*']


@given(port=st.sampled_from([None, '/dev/argument', '4001']), file=st.sampled_from(FILES),
       keys=st.lists(st.sampled_from(KEYS), unique=True, max_size=3),
       sensor=st.sampled_from([None, 'bahrs', 'titan_m']))
def test_an_argument_overrides_the_file(tmp_path_factory, port, file, keys, sensor):
    """This holds in the driver, for every key of the file."""
    params_file = tmp_path_factory.mktemp('launch') / 'my.yaml'
    lines = [f'{key}:\n  ros__parameters:\n    port: /dev/file\n'
             + (f'    sensor: {sensor}\n' if sensor else '') for key in keys]
    params_file.write_text(''.join(lines))
    launch = StandIn()
    (command,), _ = launch.run(launch.include(file, {
        'params_file': str(params_file), **({'port': port} if port else {})}))
    sensor, settings = node_settings(['driver_node', *command.words])
    assert settings.port == (port or ('/dev/file' if keys else '/dev/ttyUSB0'))
    # The name of the launch file is a choice, too, unless it is that of the default.
    in_file = sensor if keys and sensor else 'bahrs'
    assert sensor == ('titan_m' if file == 'titan_m' else in_file)


@pytest.mark.parametrize('file', FILES)
def test_defaults_of_the_launch_file_reach_the_driver(file):
    """The shipped file, from which users copy, does not contain these parameters."""
    (driver, _), _ = StandIn().run(StandIn().include(file, {'record': 'flight'}))
    _, settings = node_settings(['driver_node', *driver.words])
    assert settings.publish.static_tf and settings.startup.wait_for_subscribers == 10.0


@given(text=st.sampled_from([None, 'false', 'true']), in_file=st.sampled_from(['false', 'true']),
       keys=st.lists(st.sampled_from(KEYS), max_size=1))
def test_a_file_overrides_a_default_of_the_launch_file(tmp_path_factory, text, keys, in_file):
    """And an argument overrides both, for every key of the file."""
    params_file = tmp_path_factory.mktemp('launch') / 'my.yaml'
    params_file.write_text(''.join(
        f'{key}:\n  ros__parameters:\n    publish.static_tf: {in_file}\n'
        '    startup.wait_for_subscribers: 3.0\n' for key in keys))
    (driver, _), _ = StandIn().run(StandIn().include('bahrs', {
        'params_file': str(params_file), 'record': 'flight',
        **({'publish_static_tf': text} if text else {})}))
    _, settings = node_settings(['driver_node', *driver.words])
    assert settings.publish.static_tf == ((text or (in_file if keys else 'true')) == 'true')
    assert settings.startup.wait_for_subscribers == (3.0 if keys else 10.0)
