# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a read of a port returns: bytes, and the host's time."""

import time
from typing import NamedTuple

from bahrs_driver.clock import Instant
from bahrs_driver.host_time import paired_reading


class Reading(NamedTuple):
    """The bytes of one read, and a time by which all were there, close to the first such."""

    data: bytes
    now: Instant


def now() -> Instant:
    """Read both clocks of the host as if at once; the raw time is that of the call."""
    reading = paired_reading(time.CLOCK_MONOTONIC_RAW)
    return Instant(reading.time, reading.time + reading.offset)
