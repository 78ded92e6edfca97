# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the Makefile: a ROS that the shell has sourced does not reach the programs."""

import os
from pathlib import Path
import shutil
import subprocess

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCED = {'AMENT_PREFIX_PATH': '/opt/ros/jazzy', 'LD_LIBRARY_PATH': '/opt/ros/jazzy/lib',
           'PYTHONPATH': '/opt/ros/jazzy/lib/python3.12/site-packages',
           'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp'}
pytestmark = pytest.mark.skipif(not shutil.which('make'), reason='make is not installed')
SHOW = 'include Makefile\nshow:\n\t@env\n'


def seen(variables):
    """Return what make prints first, and the environment of its programs."""
    environment = {name: value for name, value in os.environ.items() if name not in SOURCED}
    output = subprocess.run(
        ['make', '--silent', '-f', '-', 'show'], input=SHOW, cwd=ROOT, check=True,
        env={**environment, **variables}, capture_output=True, text=True).stdout.splitlines()
    notes = [line for line in output if line.startswith('Using the ROS of .venv')]
    return notes, dict(line.split('=', 1) for line in output if '=' in line)


def test_a_shell_without_ros():
    """There is nothing to say."""
    notes, environment = seen({'ROS_DOMAIN_ID': '7'})
    assert notes == [] and environment['ROS_DOMAIN_ID'] == '7'


@pytest.mark.parametrize('names', [[name] for name in SOURCED] + [list(SOURCED)])
def test_a_shell_with_ros(names):
    """One line names the variables that are left out."""
    notes, environment = seen({name: SOURCED[name] for name in names})
    assert not SOURCED.keys() & environment.keys()
    assert notes == ['Using the ROS of .venv, without these variables of the shell: '
                     + ' '.join(names)]


def test_the_middleware_of_the_wheels():
    """It is no other ROS."""
    notes, environment = seen({'RMW_IMPLEMENTATION': 'rmw_fastrtps_cpp'})
    assert notes == [] and environment['RMW_IMPLEMENTATION'] == 'rmw_fastrtps_cpp'
