# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the user may choose."""

from dataclasses import dataclass
from typing import Literal

from bahrs_driver.clock.labels import Label
from bahrs_driver.units import NS_PER_S


@dataclass(frozen=True)
class ClockOptions:
    """What the user may choose; times in ns."""

    source: Literal['device', 'sync_pulse'] = 'device'
    label: Label = 'auto'
    fixed_latency: int = 0
    pulse_period: int = NS_PER_S
    pulse_times_told: bool = False      # rather than whole periods of ROS time
    most_held: int = 60                 # inertial samples that may wait for device time
