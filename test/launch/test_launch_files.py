# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the launch files: arguments override the file, the file overrides defaults."""

import importlib.util
from pathlib import Path
import runpy

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.settings.command_line import RosArguments
from hypothesis import given, strategies as st
import pytest
from support import launch_stand_in
from support.node_settings import node_settings

ROOT = Path(__file__).resolve().parents[2]
FILES = tuple(DEVICES)


class StandIn:
    """Runs launch files with the stand-in."""

    def __init__(self):
        """Load the launch files."""
        with pytest.MonkeyPatch.context() as patch:
            launch_stand_in.install(patch)
            self._describe = {
                name: runpy.run_path(str(ROOT / 'launch' / f'{name}.launch.py'))[
                    'generate_launch_description'] for name in FILES}

    def set_argument(self, name, value):
        """Return an action that sets an argument in the scope of the includer."""
        return launch_stand_in.SetLaunchConfiguration(name, value)

    def include(self, file, arguments):
        """Return an action that includes a file with arguments."""
        sets = [self.set_argument(*argument) for argument in arguments.items()]
        return launch_stand_in.LaunchDescription([*sets, self._describe[file]()])

    def run(self, *entities):
        """Return the arguments of the nodes that are started, and the context at the end."""
        context = launch_stand_in.LaunchContext()
        launch_stand_in.visit(launch_stand_in.LaunchDescription(entities), context)
        return context.commands, context


class Real:
    """Runs launch files with launch, and starts the driver for a moment."""

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

    def run(self, *entities):
        """Return the arguments of the nodes that are started, and the context at the end."""
        commands = []

        def started(event, context):
            commands.append(event.cmd[1:])
            return [self._actions.Shutdown()] if len(commands) == count else []

        count = len([entity for entity in entities if not isinstance(entity, self.set_argument)])
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
    """Return the name, namespace and parameter files of a node, and the parameters of rules."""
    remaps = dict(word.split(':=') for word in command if word.startswith('__'))
    arguments = RosArguments.from_words(command)
    values = {name: value.splitlines()[0] for name, value in (
        rule.split(':=') for rule in arguments.last_rules.values())}
    return (remaps['__node'], remaps['__ns'], [Path(file).name for file in arguments.files],
            values)


def test_no_arguments(launch):
    """The name is that of the package; only a device other than the default is passed on."""
    commands, _ = launch.run(launch.include('bahrs', {}), launch.include('titan_m', {}))
    assert [of_node(command) for command in commands] == [
        ('bahrs_driver', '/', ['bahrs.yaml'], {}),
        ('bahrs_driver', '/', ['titan_m.yaml'], {'sensor': 'titan_m'})]


def test_all_arguments(launch, tmp_path):
    """A port that looks like a number stays a text."""
    file = tmp_path / 'my.yaml'
    file.touch()
    (command,), _ = launch.run(launch.include('bahrs', {
        'port': '4001', 'name': 'front', 'namespace': 'left', 'params_file': str(file)}))
    assert of_node(command) == ('front', '/left', ['my.yaml'], {'port': "'4001'"})


def test_two_includes(launch, tmp_path):
    """Arguments of one include do not reach the next, but stay in the scope of the includer."""
    file = tmp_path / 'my.yaml'
    file.touch()
    first = {'port': '/dev/b', 'name': 'front', 'namespace': 'left', 'params_file': str(file)}
    commands, context = launch.run(launch.include('bahrs', first),
                                   launch.include('titan_m', {'port': '/dev/t'}))
    assert [of_node(command) for command in commands] == [
        ('front', '/left', ['my.yaml'], {'port': '/dev/b'}),
        ('bahrs_driver', '/', ['titan_m.yaml'], {'sensor': 'titan_m', 'port': '/dev/t'})]
    assert context.launch_configurations == {**first, 'port': '/dev/t'}


def test_the_same_namespace_for_both(launch):
    """Each include gets it."""
    commands, _ = launch.run(
        launch.include('titan_m', {'namespace': 'left', 'name': 'a'}),
        launch.include('bahrs', {'namespace': 'left', 'name': 'b'}))
    assert [of_node(command)[:2] for command in commands] == [('a', '/left'), ('b', '/left')]


def test_an_argument_of_the_includer(launch):
    """The first include gets it, as with any launch file; later includes need their own."""
    commands, context = launch.run(
        launch.set_argument('namespace', 'left'),
        launch.include('bahrs', {}), launch.include('bahrs', {}))
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


VALUES = {'port': st.sampled_from(['/dev/a', 'socket://host:1', '4001', 'true', "it's: [x] #"]),
          'name': st.sampled_from(['front', 'bahrs_driver']),
          'namespace': st.sampled_from(['left', '/right/inner', '']),
          'params_file': st.sampled_from([str(ROOT / 'config' / f'{name}.yaml')
                                          for name in FILES])}
INCLUDES = st.tuples(st.sampled_from(FILES), st.fixed_dictionaries({}, optional=VALUES))


@given(includes=st.lists(INCLUDES, min_size=1, max_size=4))
def test_includes_are_independent(includes):
    """Earlier includes have no effect."""
    launch = StandIn()
    together, _ = launch.run(*(launch.include(*include) for include in includes))
    alone = [launch.run(launch.include(*include))[0][0] for include in includes]
    assert together == alone


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
    sensor, settings = node_settings(['driver_node', *command])
    assert settings.port == (port or ('/dev/file' if keys else '/dev/ttyUSB0'))
    # The name of the launch file is a choice, too, unless it is that of the default.
    in_file = sensor if keys and sensor else 'bahrs'
    assert sensor == ('titan_m' if file == 'titan_m' else in_file)
