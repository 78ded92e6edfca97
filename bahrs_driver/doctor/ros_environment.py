# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Whether nodes started here find ROS, this package, and each other."""

from collections.abc import Iterator, Mapping
import os
from pathlib import Path
import re

from bahrs_driver.doctor.finding import advice, Finding, good, problem
from bahrs_driver.process.printable import printable
from bahrs_driver.ros.start import middlewares, SAFE_DOMAIN, valid_domain

PACKAGE = 'bahrs_driver'
DISTRIBUTION = 'jazzy'
RANGES = ('SUBNET', 'LOCALHOST', 'OFF', 'SYSTEM_DEFAULT')


def look(environment: Mapping[str, str], has_rclpy: bool, python: Path) -> Iterator[Finding]:
    """Yield findings about the variables of ROS; python is the prefix of this Python."""
    prefixes = [Path(item) for item in environment.get('AMENT_PREFIX_PATH', '').split(':') if item]
    if not has_rclpy:
        yield problem('ROS', 'rclpy cannot be imported: the set-up of ROS was not sourced',
                      f'source /opt/ros/{DISTRIBUTION}/setup.bash')
        return
    if prefixes:
        yield from _distribution(environment, prefixes)
        yield from _package(prefixes)
    else:
        yield good('ROS', f'comes from the Python packages in {python}: driver_node and bahrs are '
                          'in its bin, and there is no ros2 command')
    yield from _middleware(environment, python)
    yield _domain(environment)
    yield from _range(environment)


def _distribution(environment: Mapping[str, str], prefixes: list[Path]) -> Iterator[Finding]:
    found = sorted({match[1] for prefix in prefixes
                    if (match := re.match(r'/opt/ros/(\w+)', str(prefix)))})
    if len(found) > 1:
        yield problem('ROS', f'{" and ".join(found)} are sourced in the same shell: begin a new '
                             'one with one of them',
                      f'env -i HOME="$HOME" bash --rcfile /opt/ros/{DISTRIBUTION}/setup.bash')
        return
    name = environment.get('ROS_DISTRO') or ''.join(found)
    if name and name != DISTRIBUTION:
        yield advice('ROS', f'is {name}: this package is tested on {DISTRIBUTION}',
                     f'source /opt/ros/{DISTRIBUTION}/setup.bash')
    else:
        yield good('ROS', f'is {name or "there, of no named distribution"}')


def _package(prefixes: list[Path]) -> Iterator[Finding]:
    index = f'share/ament_index/resource_index/packages/{PACKAGE}'
    where = next((prefix for prefix in prefixes if os.path.exists(prefix / index)), None)
    if where:
        yield good('package', f'{PACKAGE} is in {where}')
    else:
        yield advice('package', f'{PACKAGE} is not on AMENT_PREFIX_PATH: "ros2 run {PACKAGE}" '
                                'does not find it', 'source install/setup.bash')


def _middleware(environment: Mapping[str, str], python: Path) -> Iterator[Finding]:
    there, chosen = middlewares(environment, python), environment.get('RMW_IMPLEMENTATION', '')
    if chosen and there and chosen not in there:
        known = re.fullmatch(r'rmw_\w+', chosen, re.ASCII)
        yield problem('middleware', f'RMW_IMPLEMENTATION is {chosen}, which is not installed; '
                                    f'there is {", ".join(there)}',
                      f'sudo apt install ros-{DISTRIBUTION}-{chosen.replace("_", "-")}'
                      if known else 'unset RMW_IMPLEMENTATION')
    elif chosen:
        yield good('middleware', f'is {chosen}, as RMW_IMPLEMENTATION says: that of every other '
                                 'machine must be the same')
    else:
        default = 'the default' + (f' (there is {", ".join(there)})' if there else '')
        yield good('middleware', f'is {default}')


def _domain(environment: Mapping[str, str]) -> Finding:
    text = environment.get('ROS_DOMAIN_ID', '')
    if not text:
        return good('domain', 'is 0, the default')
    if valid_domain(text, SAFE_DOMAIN):
        return good('domain', f'is {text}: whoever listens must have the same ROS_DOMAIN_ID')
    return problem('domain', f"ROS_DOMAIN_ID is '{printable(text)}': it must be a number from 0 "
                             f'to {SAFE_DOMAIN}', 'export ROS_DOMAIN_ID=0')


def _range(environment: Mapping[str, str]) -> Iterator[Finding]:
    chosen = environment.get('ROS_AUTOMATIC_DISCOVERY_RANGE', '')
    if environment.get('ROS_LOCALHOST_ONLY') == '1':
        yield advice('discovery', 'ROS_LOCALHOST_ONLY=1 hides all nodes of other machines, and is '
                                  'out of use in Jazzy', 'unset ROS_LOCALHOST_ONLY')
    if chosen and chosen not in RANGES:
        yield problem('discovery', f'ROS_AUTOMATIC_DISCOVERY_RANGE is {chosen!r}: it must be '
                                   f'{", ".join(RANGES)}', 'unset ROS_AUTOMATIC_DISCOVERY_RANGE')
    elif chosen == 'OFF':
        yield problem('discovery', 'ROS_AUTOMATIC_DISCOVERY_RANGE is OFF: no node finds another',
                      'unset ROS_AUTOMATIC_DISCOVERY_RANGE')
    elif chosen == 'LOCALHOST':
        yield good('discovery', 'nodes of this machine only')
    else:
        yield good('discovery', 'nodes of this network')
