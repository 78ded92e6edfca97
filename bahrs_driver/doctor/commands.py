# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Build the commands that the doctor suggests, quoted for a shell."""

import shlex

from bahrs_driver.devices.registry import DEFAULT

RUN_DRIVER = 'ros2 run bahrs_driver driver_node'
USUAL_BAUD_RATE = 115200


def run_driver(port: str, sensor: str = DEFAULT, baud_rate: int = USUAL_BAUD_RATE) -> str:
    """Return the command that starts a driver, with the parameters that are not the defaults."""
    rules = [*([f'sensor:={sensor}'] if sensor != DEFAULT else []), f'port:={port}',
             *([f'baud_rate:={baud_rate}'] if baud_rate != USUAL_BAUD_RATE else [])]
    return f'{RUN_DRIVER} --ros-args ' + ' '.join(f'-p {shlex.quote(rule)}' for rule in rules)


def run_doctor(port: str, baud_rate: int = USUAL_BAUD_RATE, ask: bool = False) -> str:
    """Return the command that checks a port."""
    rate = ['--baud-rate', str(baud_rate)] if baud_rate != USUAL_BAUD_RATE else []
    return shlex.join(['bahrs', 'doctor', '--port', port, *rate, *(['--ask'] if ask else [])])
