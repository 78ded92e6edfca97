# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Options of the clock of a device that streams samples."""

from dataclasses import dataclass
from typing import Literal

from bahrs_driver.clock.time_reference import Label
from bahrs_driver.units import NS_PER_S


@dataclass(frozen=True)
class ClockOptions:
    """Options that the user sets; times in ns."""

    source: Literal['device', 'sync_pulse'] = 'device'
    label: Label = 'auto'
    fixed_latency: int = 0                  # subtracted from each stamp
    pulse_period: int = NS_PER_S
    external_pulse_times: bool = False      # rather than whole periods of ROS time
    most_held: int = 60                     # samples that may wait for device time
