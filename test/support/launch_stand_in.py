# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
As much of launch and launch_ros as our launch files use, for machines that do not have them.

What matters is the life of an argument: a file that is included finds it in the scope of whoever
included it, where it stays; a default is set only where there is no value; a group has a scope.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
import runpy
import sys
from types import ModuleType
from typing import Any, NamedTuple, Protocol

import yaml

ROOT = Path(__file__).resolve().parents[2]


class Substitution(Protocol):
    """What stands for a text that is known only when it is used."""

    def perform(self, context: 'LaunchContext') -> str:
        """Return the text."""


Text = str | Substitution


class Command(NamedTuple):
    """A process that was started."""

    executable: str
    words: list[str]
    respawn: bool = False


class LaunchContext:
    """Arguments by name, and the commands that were started."""

    def __init__(self) -> None:
        """Begin with no arguments."""
        self.launch_configurations: dict[str, str] = {}
        self.commands: list[Command] = []
        self.log: list[str] = []


class LaunchDescriptionEntity:
    """What does something in a context, and returns what is to be done then."""

    def execute(self, context: LaunchContext) -> 'Entities | None':
        """Do nothing."""
        return None


Entities = Iterable[LaunchDescriptionEntity]


class LaunchDescription(LaunchDescriptionEntity):
    """Entities, one after the other."""

    def __init__(self, entities: Entities) -> None:
        self.entities = entities

    def execute(self, context: LaunchContext) -> Entities:
        return self.entities


class DeclareLaunchArgument(LaunchDescriptionEntity):
    """An argument, which has its default where it has no value."""

    def __init__(self, name: str, *, default_value: Text | None = None, description: str,
                 choices: Sequence[str] | None = None) -> None:
        assert description and (not choices or default_value in choices)
        self.name, self.default, self.choices = name, default_value, choices

    def execute(self, context: LaunchContext) -> None:
        values = context.launch_configurations
        if self.name not in values:
            if self.default is None:
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided')
            values[self.name] = performed(self.default, context)
        if self.choices and values[self.name] not in self.choices:
            raise RuntimeError(f'Argument "{self.name}" provided value "{values[self.name]}" is '
                               f'not valid. Valid options are: {self.choices}')


class SetLaunchConfiguration(LaunchDescriptionEntity):
    """A value that is set whatever there is."""

    def __init__(self, name: str, value: Text) -> None:
        self.name, self.value = name, value

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations[self.name] = performed(self.value, context)


class IncludeLaunchDescription(LaunchDescriptionEntity):
    """A launch file, whose arguments are set in the scope of the including one."""

    def __init__(self, path: Text, *, launch_arguments: Iterable[tuple[str, Text]]) -> None:
        self.path, self.arguments = path, launch_arguments

    def execute(self, context: LaunchContext) -> Entities:
        described = generator(performed(self.path, context))()
        return [*(SetLaunchConfiguration(*argument) for argument in self.arguments), described]


@cache
def generator(path: str) -> Callable[[], LaunchDescription]:
    """Load a launch file, the first time with the stand-in installed."""
    generate: Callable[[], LaunchDescription] = runpy.run_path(path)['generate_launch_description']
    return generate


class GroupAction(LaunchDescriptionEntity):
    """Entities with a scope of their own."""

    def __init__(self, actions: Entities, *, scoped: bool = True) -> None:
        self.actions, self.scoped = actions, scoped

    def execute(self, context: LaunchContext) -> None:
        outside = context.launch_configurations
        if self.scoped:
            context.launch_configurations = dict(outside)
        for action in self.actions:
            visit(action, context)
        context.launch_configurations = outside


class OpaqueFunction(LaunchDescriptionEntity):
    """A function of the context."""

    def __init__(self, *, function: Callable[..., Entities | None],
                 args: Sequence[Any] = ()) -> None:
        self.function, self.arguments = function, args

    def execute(self, context: LaunchContext) -> Entities | None:
        return self.function(context, *self.arguments)


class LogInfo(LaunchDescriptionEntity):
    """A line of the log."""

    def __init__(self, *, msg: str) -> None:
        self.text = msg

    def execute(self, context: LaunchContext) -> None:
        context.log.append(self.text)


class Parameter:
    """A parameter of a node."""

    def __init__(self, name: str, value: object, *, value_type: type | None = None) -> None:
        assert value_type is None or type(value) is value_type
        self.rule = f'{name}:={yaml.safe_dump(value)}'


class Node(LaunchDescriptionEntity):
    """A process, of which only the command is made."""

    def __init__(self, *, package: str, executable: str, namespace: str, output: str,
                 name: str = '', parameters: Iterable[Parameter | Text] = (),
                 arguments: Sequence[Text] = (), ros_arguments: Sequence[str] | None = None,
                 remappings: Iterable[tuple[str, str]] = (), respawn: bool = False,
                 respawn_delay: float = 0.0) -> None:
        assert package in ('bahrs_driver', 'rviz2', 'robot_localization') and output == 'screen'
        self.respawn = respawn
        words = [executable, *arguments]
        if ros_arguments is not None:
            words += ['--ros-args', *ros_arguments]
        words += ['--ros-args', *(['-r', f'__node:={name}'] if name else []),
                  '-r', f"__ns:=/{namespace.strip('/')}"]
        for item in parameters:
            words += ['-p', item.rule] if isinstance(item, Parameter) else ['--params-file', item]
        for old, new in remappings:
            words += ['-r', f'{old}:={new}']
        self.words = words

    def execute(self, context: LaunchContext) -> None:
        executable, *words = (performed(word, context) for word in self.words)
        context.commands.append(Command(executable, words, self.respawn))


class PathJoinSubstitution:
    """A path of several parts."""

    def __init__(self, parts: Iterable[Text]) -> None:
        self.parts = parts

    def perform(self, context: LaunchContext) -> str:
        return str(Path(*(performed(part, context) for part in self.parts)))


class LaunchConfiguration:
    """The value of an argument."""

    def __init__(self, name: str) -> None:
        self.name = name

    def perform(self, context: LaunchContext) -> str:
        return context.launch_configurations[self.name]


class FindPackageShare:
    """Where the files of a package are: here, those of the sources."""

    def __init__(self, package: str) -> None:
        assert package == 'bahrs_driver'

    def perform(self, _context: LaunchContext) -> str:
        return str(ROOT)


def performed(value: Text, context: LaunchContext) -> str:
    """Return the text that a substitution stands for, as launch does: never of a subclass."""
    return ''.join([value if isinstance(value, str) else value.perform(context)])


def visit(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Do what an entity says."""
    for following in entity.execute(context) or ():
        visit(following, context)


def install(monkeypatch: Any) -> None:
    """Put these in the place of launch and launch_ros."""
    modules: dict[str, tuple[type, ...]] = {
        'launch': (LaunchContext, LaunchDescription, LaunchDescriptionEntity),
        'launch.actions': (DeclareLaunchArgument, GroupAction, IncludeLaunchDescription, LogInfo,
                           OpaqueFunction),
        'launch.substitutions': (LaunchConfiguration, PathJoinSubstitution),
        'launch_ros': (),
        'launch_ros.actions': (Node,),
        'launch_ros.descriptions': (Parameter,),
        'launch_ros.substitutions': (FindPackageShare,)}
    for name, classes in modules.items():
        module = ModuleType(name)
        for each in classes:
            setattr(module, each.__name__, each)
        monkeypatch.setitem(sys.modules, name, module)
    # One that was imported with launch itself is for later.
    monkeypatch.setitem(sys.modules, 'bahrs_driver.node.launching', None)
    del sys.modules['bahrs_driver.node.launching']
