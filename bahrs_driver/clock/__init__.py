# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time on host time. Pure: host time is handed in, nothing here reads a clock.

Made of small rooms: `bounds` (what a read says of a frame), `host` (the host's two clocks),
`counter`, `labels`, `navigation`, `timeline` and `device_time` (sequence numbers to device
time), `tracker` and `pulses` over `kalman` (device time to host time), `held` (messages that wait
for a stamp), `stamper` over `output` (stamps), `notices`, and `sample_clock`, which holds them
together. `smoother`, over `rauch`, stands in for the tracker when the whole recording is there.
`exchange` is for devices that answer requests.
"""

from bahrs_driver.clock.arrival import ArrivalClock, ArrivalStamps
from bahrs_driver.clock.exchange import ExchangeClock
from bahrs_driver.clock.interface import Clock, Instant, Stamped, TimeState
from bahrs_driver.clock.options import ClockOptions
from bahrs_driver.clock.sample_clock import SampleClock

__all__ = [
    'ArrivalClock', 'ArrivalStamps', 'Clock', 'ClockOptions', 'ExchangeClock', 'Instant',
    'SampleClock', 'Stamped', 'TimeState']
