# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What launch files start, by the stand-in for launch, and a package that they look for."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from support import launch_stand_in
from support.launch_stand_in import Command

ROOT = Path(__file__).resolve().parents[2]


class StandIn:
    """Runs launch files with the stand-in."""

    def __init__(self) -> None:
        """Load the launch files."""
        with pytest.MonkeyPatch.context() as patch:
            launch_stand_in.install(patch)
            for file in (ROOT / 'launch').glob('*.py'):
                launch_stand_in.generator(str(file))

    def set_argument(self, name: str, value: str) -> launch_stand_in.SetLaunchConfiguration:
        """Return an action that sets an argument in the scope of the includer."""
        return launch_stand_in.SetLaunchConfiguration(name, value)

    def include(self, file: str, arguments: Mapping[str, str]
                ) -> launch_stand_in.IncludeLaunchDescription:
        """Return an action that includes a file with arguments."""
        return launch_stand_in.IncludeLaunchDescription(
            str(ROOT / 'launch' / f'{file}.launch.py'), launch_arguments=arguments.items())

    def run(self, *entities: launch_stand_in.LaunchDescriptionEntity, count: int = 1
            ) -> tuple[list[Command], launch_stand_in.LaunchContext]:
        """Return the commands that are started, and the context at the end."""
        context = launch_stand_in.LaunchContext()
        launch_stand_in.visit(launch_stand_in.LaunchDescription(entities), context)
        return context.commands, context


def install_filter(folder: Path) -> Path:
    """Install nodes that do nothing as robot_localization, and return the prefix."""
    index = folder / 'share' / 'ament_index' / 'resource_index' / 'packages'
    programs = folder / 'lib' / 'robot_localization'
    for directory in (index, programs):
        directory.mkdir(parents=True)
    (index / 'robot_localization').touch()
    for name in ('ekf_node', 'navsat_transform_node'):
        (programs / name).write_text('#!/bin/sh\nexec cat >/dev/null\n')
        (programs / name).chmod(0o755)
    return folder
