# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the driver needs of a sensor, in a module for each.

A new sensor is a protocol module, a converter, an emulator, and a module here.
"""

from collections.abc import Callable, Mapping
from typing import Any

from bahrs_driver.devices import titan_m
from bahrs_driver.devices.bahrs import bahrs, ROS_CLOCK
from bahrs_driver.devices.spec import Sensor
from bahrs_driver.transport.link import Link

SENSORS: dict[str, Callable[[Mapping[str, Any], Link], Sensor]] = {
    'bahrs': bahrs, 'titan_m': titan_m.titan_m}
# Settings with which a sensor asks nothing, and takes what comes: for recordings.
LISTENING: dict[str, Mapping[str, Any]] = {'titan_m': titan_m.LISTENING}

__all__ = ['LISTENING', 'ROS_CLOCK', 'SENSORS', 'Sensor']
