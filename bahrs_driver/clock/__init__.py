# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Device time to host time. Pure: host time is an argument, nothing here reads a clock.

A sample becomes a stamp in three steps:

    counter, time_reference, navigation, timeline, device_time     sequence number -> device time
    read_observer (bounds, host), estimation                       device time -> host time
    held, stamp_queue, slewer, stamper                             host time -> stamp

`sample_clock` combines them for a device that streams samples with device time, `exchange` is the
clock of a device that answers requests, and `arrival` the one of any device without estimation.
All three extend `interface.Clock`. `estimation` has a live estimate (`tracker`) and, for
recordings, one that uses all samples (`smoother`).
"""

from bahrs_driver.clock.arrival import ArrivalClock
from bahrs_driver.clock.exchange import ExchangeClock
from bahrs_driver.clock.interface import Clock, Instant, Smoothing, Stamped, TimeState
from bahrs_driver.clock.options import ClockOptions
from bahrs_driver.clock.sample_clock import SampleClock

__all__ = [
    'ArrivalClock', 'Clock', 'ClockOptions', 'ExchangeClock', 'Instant', 'SampleClock',
    'Smoothing', 'Stamped', 'TimeState']
