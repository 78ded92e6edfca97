# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Build the commands that the doctor suggests, quoted for a shell."""

import os
import shlex

from bahrs_driver.devices.registry import DEFAULT

USUAL_BAUD_RATE = 115200


def driver_command(flag: str, *rules: str) -> str:
    """Return the command that starts a driver with ROS rules, each after a flag such as -p."""
    # ROS from Python packages has no ros2 command.
    run = 'ros2 run bahrs_driver ' if os.environ.get('AMENT_PREFIX_PATH') else ''
    return f'{run}driver_node --ros-args ' + ' '.join(
        f'{flag} {shlex.quote(rule)}' for rule in rules)


def run_driver(port: str, sensor: str = DEFAULT, baud_rate: int = USUAL_BAUD_RATE) -> str:
    """Return the command that starts a driver, with the parameters that are not the defaults."""
    return driver_command(
        '-p', *([f'sensor:={sensor}'] if sensor != DEFAULT else []), f'port:={port}',
        *([f'baud_rate:={baud_rate}'] if baud_rate != USUAL_BAUD_RATE else []))


def run_doctor(port: str, baud_rate: int = USUAL_BAUD_RATE, ask: bool = False) -> str:
    """Return the command that checks a port."""
    rate = ['--baud-rate', str(baud_rate)] if baud_rate != USUAL_BAUD_RATE else []
    return shlex.join(['bahrs', 'doctor', '--port', port, *rate, *(['--ask'] if ask else [])])
