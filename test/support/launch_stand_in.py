# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
As much of launch and launch_ros as our launch files use, for machines that do not have them.

What matters is the life of an argument: a file that is included finds it in the scope of whoever
included it, where it stays; a default is set only where there is no value; a group has a scope.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
import sys
from types import ModuleType
from typing import Any, Protocol

import yaml

ROOT = Path(__file__).resolve().parents[2]


class Substitution(Protocol):
    """What stands for a text that is known only when it is used."""

    def perform(self) -> str:
        """Return the text."""


Text = str | Substitution


class LaunchContext:
    """Arguments by name, and the commands of the nodes that were started."""

    def __init__(self) -> None:
        """Begin with no arguments."""
        self.launch_configurations: dict[str, str] = {}
        self.commands: list[list[str]] = []
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

    def __init__(self, name: str, *, default_value: Text, description: str) -> None:
        assert description
        self.name, self.default = name, default_value

    def execute(self, context: LaunchContext) -> None:
        if self.name not in context.launch_configurations:
            context.launch_configurations[self.name] = performed(self.default)


class SetLaunchConfiguration(LaunchDescriptionEntity):
    """A value that is set whatever there is."""

    def __init__(self, name: str, value: Text) -> None:
        self.name, self.value = name, value

    def execute(self, context: LaunchContext) -> None:
        context.launch_configurations[self.name] = performed(self.value)


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

    def __init__(self, *, package: str, executable: str, name: str, namespace: str,
                 parameters: Iterable[Parameter | str], output: str) -> None:
        assert (package, executable, output) == ('bahrs_driver', 'driver_node', 'screen')
        self.command = ['--ros-args', '-r', f'__node:={name}',
                        '-r', f"__ns:=/{namespace.strip('/')}"]
        for item in parameters:
            self.command += ['-p', item.rule] if isinstance(item, Parameter) \
                else ['--params-file', item]

    def execute(self, context: LaunchContext) -> None:
        context.commands.append(self.command)


class PathJoinSubstitution:
    """A path of several parts."""

    def __init__(self, parts: Iterable[Text]) -> None:
        self.parts = parts

    def perform(self) -> str:
        return str(Path(*map(performed, self.parts)))


class FindPackageShare:
    """Where the files of a package are: here, those of the sources."""

    def __init__(self, package: str) -> None:
        assert package == 'bahrs_driver'

    def perform(self) -> str:
        return str(ROOT)


def performed(value: Text) -> str:
    """Return the text that a substitution stands for, as launch does: never of a subclass."""
    return ''.join([value if isinstance(value, str) else value.perform()])


def visit(entity: LaunchDescriptionEntity, context: LaunchContext) -> None:
    """Do what an entity says."""
    for following in entity.execute(context) or ():
        visit(following, context)


def install(monkeypatch: Any) -> None:
    """Put these in the place of launch and launch_ros."""
    modules: dict[str, tuple[type, ...]] = {
        'launch': (LaunchContext, LaunchDescription, LaunchDescriptionEntity),
        'launch.actions': (DeclareLaunchArgument, GroupAction, LogInfo, OpaqueFunction),
        'launch.substitutions': (PathJoinSubstitution,),
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
