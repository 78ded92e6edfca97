# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Check the environment of ROS before ROS is started.

Some values of variables make ROS end the process, without an exception: an unknown
RMW_IMPLEMENTATION does so when rclpy is imported. So this module does not import rclpy.
"""

from collections.abc import Iterator, Mapping
import contextlib
import os
from pathlib import Path
import re
import sys
import tempfile
from typing import NamedTuple

from bahrs_driver.process.printable import printable

DISTRIBUTION = 'jazzy'
HIGHEST_DOMAIN = 232            # above, its ports would be beyond 65535
SAFE_DOMAIN = 101               # above, its ports collide with the ephemeral ports of Linux
LOADER = 'rmw_implementation'   # loads a middleware, and is none itself
SWITCHES = ('RCUTILS_COLORIZED_OUTPUT', 'RCUTILS_LOGGING_USE_STDOUT',
            'RCUTILS_LOGGING_BUFFERED_STREAM')
_MIDDLEWARES = 'share/ament_index/resource_index/rmw_typesupport'


class EnvironmentProblem(NamedTuple):
    """A variable with which ROS does not start."""

    check: str              # 'middleware', 'logging' or 'domain'
    message: str            # the mistake, and the valid values
    command: str            # the command that corrects it


def environment_problems(environment: Mapping[str, str], python: Path = Path(sys.prefix),
                         highest_domain: int = HIGHEST_DOMAIN) -> Iterator[EnvironmentProblem]:
    """Yield the variables with which ROS does not start; python is the prefix of this Python."""
    yield from import_problems(environment, python)
    text = environment.get('ROS_DOMAIN_ID', '')
    if not _is_domain(text, highest_domain):
        yield EnvironmentProblem(
            'domain', f'ROS_DOMAIN_ID is {_quoted(text)}: it must be a number from 0 to '
                      f'{SAFE_DOMAIN}', 'export ROS_DOMAIN_ID=0')


def import_problems(environment: Mapping[str, str],
                    python: Path = Path(sys.prefix)) -> Iterator[EnvironmentProblem]:
    """Yield the variables with which importing rclpy ends the process, or floods its output."""
    chosen, installed = environment.get('RMW_IMPLEMENTATION', ''), middlewares(environment, python)
    if chosen and installed and chosen not in installed:
        is_name = re.fullmatch(r'rmw_\w+', chosen, re.ASCII)
        yield EnvironmentProblem(
            'middleware', f'RMW_IMPLEMENTATION is {_quoted(chosen)}, which is not installed: '
                          f'unset it, or set it to {" or ".join(installed)}',
            f'sudo apt install ros-{DISTRIBUTION}-{chosen.replace("_", "-")}' if is_name
            else 'unset RMW_IMPLEMENTATION')
    for name in SWITCHES:
        if environment.get(name, '') not in ('', '0', '1'):
            yield EnvironmentProblem(
                'logging', f'{name} is {_quoted(environment[name])}: it must be 0 or 1',
                f'unset {name}')


def middlewares(environment: Mapping[str, str], python: Path = Path(sys.prefix)) -> list[str]:
    """Return the installed middlewares; none if there is no index of them."""
    prefixes = ament_prefixes(environment)
    found: set[str] = set()
    for prefix in prefixes or [python]:
        with contextlib.suppress(OSError, ValueError):      # a prefix may be any text
            found.update(os.listdir(prefix / _MIDDLEWARES))
    return sorted(name for name in found if name.startswith('rmw_') and name != LOADER)


def ament_prefixes(environment: Mapping[str, str]) -> list[Path]:
    """Return the folders that AMENT_PREFIX_PATH names."""
    return [Path(item) for item in environment.get('AMENT_PREFIX_PATH', '').split(':') if item]


def log_directory(environment: Mapping[str, str] = os.environ) -> str:
    """Return where ROS writes its log files; with a ~ if there is no home directory."""
    text = environment.get('ROS_LOG_DIR') or \
        os.path.join(environment.get('ROS_HOME') or '~/.ros', 'log')
    home = environment.get('HOME', '')
    return home + text[1:] if home and text.startswith('~') else text


def log_problem(environment: Mapping[str, str] = os.environ) -> str:
    """Return why ROS cannot write log files; empty if it can. Leaves no file behind."""
    folder = log_directory(environment)
    if folder.startswith('~'):
        return f'{_quoted(folder)} needs HOME, which is not set'
    parent = Path(os.path.abspath(folder))
    try:
        while not parent.exists():
            parent = parent.parent
    except (OSError, ValueError) as error:
        return f'{_quoted(folder)} cannot be used: {printable(error)}'
    if not parent.is_dir():
        return f'{_quoted(folder)} cannot be made: {_quoted(parent)} is no directory'
    try:
        # Permissions are not enough: a file system may be full, or hold no files.
        with tempfile.TemporaryFile(dir=parent):
            return ''
    except OSError as error:
        return f'{_quoted(parent)} cannot be written: {printable(error.strerror)}'


def _is_domain(text: str, highest: int) -> bool:
    """Return whether a text is a domain up to a number; without text it is the default."""
    return not text or (text.isascii() and text.isdecimal() and len(text) < 10
                        and int(text) <= highest)


def _quoted(text: object) -> str:
    return f"'{printable(text)}'"
