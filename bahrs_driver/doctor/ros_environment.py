# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check whether nodes started here find ROS, this package and each other, and can log."""

from collections.abc import Iterator, Mapping
import os
from pathlib import Path
import re
import shlex
import tempfile

from bahrs_driver.doctor.check_result import advice, CheckResult, ok, Prevents, problem
from bahrs_driver.ros.environment import (
    ament_prefixes, DISTRIBUTION, environment_problems, log_directory, log_problem, middlewares,
    SAFE_DOMAIN,
)

PACKAGE = 'bahrs_driver'
RANGES = ('SUBNET', 'LOCALHOST', 'OFF', 'SYSTEM_DEFAULT')


def check(environment: Mapping[str, str], has_rclpy: bool, python: Path) -> Iterator[CheckResult]:
    """Check the variables of ROS; python is the prefix of this Python."""
    prefixes = ament_prefixes(environment)
    if not has_rclpy:
        yield problem('ROS', 'rclpy cannot be imported: the set-up of ROS was not sourced',
                      f'source /opt/ros/{DISTRIBUTION}/setup.bash', Prevents.ROS)
        return
    if prefixes:
        yield from _distribution(environment, prefixes)
        yield from _package(prefixes)
    else:
        yield ok('ROS', f'comes from the Python packages in {python}: driver_node and bahrs are '
                        'in its bin, and there is no ros2 command')
    problems = list(environment_problems(environment, python, SAFE_DOMAIN))
    for found in problems:
        yield problem(*found, Prevents.ROS)
    failed = {found.check for found in problems}
    if 'middleware' not in failed:
        yield _middleware(environment, python)
    if 'domain' not in failed:
        yield _domain(environment)
    yield from _range(environment)
    yield _log_files(environment)


def _distribution(environment: Mapping[str, str], prefixes: list[Path]) -> Iterator[CheckResult]:
    found = sorted({match[1] for prefix in prefixes
                    if (match := re.match(r'/opt/ros/(\w+)', str(prefix)))})
    if len(found) > 1:
        yield problem('ROS', f'{" and ".join(found)} are sourced in the same shell: start a new '
                             'shell with one of them',
                      f'env -i HOME="$HOME" bash --rcfile /opt/ros/{DISTRIBUTION}/setup.bash')
        return
    name = environment.get('ROS_DISTRO') or ''.join(found)
    if name and name != DISTRIBUTION:
        yield advice('ROS', f'is {name}: this package is tested on {DISTRIBUTION}',
                     f'source /opt/ros/{DISTRIBUTION}/setup.bash')
    else:
        yield ok('ROS', f'is {name or "of an unnamed distribution"}')


def _package(prefixes: list[Path]) -> Iterator[CheckResult]:
    index = f'share/ament_index/resource_index/packages/{PACKAGE}'
    found = next((prefix for prefix in prefixes if os.path.exists(prefix / index)), None)
    if found:
        yield ok('package', f'{PACKAGE} is in {found}')
    else:
        yield advice('package', f'{PACKAGE} is not on AMENT_PREFIX_PATH: "ros2 run {PACKAGE}" '
                                'does not find it', 'source install/setup.bash')


def _middleware(environment: Mapping[str, str], python: Path) -> CheckResult:
    installed = middlewares(environment, python)
    chosen = environment.get('RMW_IMPLEMENTATION', '')
    if chosen:
        return ok('middleware', f'is {chosen}, from RMW_IMPLEMENTATION: every other machine must '
                                'use the same')
    names = f' (installed: {", ".join(installed)})' if installed else ''
    return ok('middleware', f'is the default{names}')


def _domain(environment: Mapping[str, str]) -> CheckResult:
    text = environment.get('ROS_DOMAIN_ID', '')
    if not text:
        return ok('domain', 'is 0, the default')
    return ok('domain', f'is {text}: every subscriber must have the same ROS_DOMAIN_ID')


def _range(environment: Mapping[str, str]) -> Iterator[CheckResult]:
    chosen = environment.get('ROS_AUTOMATIC_DISCOVERY_RANGE', '')
    if environment.get('ROS_LOCALHOST_ONLY') == '1':
        yield advice('discovery', 'ROS_LOCALHOST_ONLY=1 hides all nodes of other machines, and is '
                                  'deprecated in Jazzy', 'unset ROS_LOCALHOST_ONLY')
    if chosen and chosen not in RANGES:
        yield problem('discovery', f'ROS_AUTOMATIC_DISCOVERY_RANGE is {chosen!r}: it must be '
                                   f'{", ".join(RANGES)}', 'unset ROS_AUTOMATIC_DISCOVERY_RANGE')
    elif chosen == 'OFF':
        yield problem('discovery', 'ROS_AUTOMATIC_DISCOVERY_RANGE is OFF: no node finds another',
                      'unset ROS_AUTOMATIC_DISCOVERY_RANGE')
    elif chosen == 'LOCALHOST':
        yield ok('discovery', 'nodes of this machine only')
    else:
        yield ok('discovery', 'nodes of this network')


def _log_files(environment: Mapping[str, str]) -> CheckResult:
    reason = log_problem(environment)
    if not reason:
        return ok('log files', f'go to {log_directory(environment)}')
    folder = Path(tempfile.gettempdir()) / 'ros_logs'
    return advice('log files', f'nodes write none: {reason}',
                  f'export ROS_LOG_DIR={shlex.quote(str(folder))}')
