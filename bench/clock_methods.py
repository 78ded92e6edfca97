# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Stamp samples by the clock of this driver, and by the methods of other drivers.

The other methods use more than a driver has: the true device time of every sample.
"""

from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

from bahrs_driver.clock import ClockOptions, Instant, SampleClock, Stamped
from bahrs_driver.protocol.bahrs.messages import Inertial
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import NS_PER_S
from clock_simulation import BYTE_TIME, Case, ORIGIN, Simulation

AVERAGE_WEIGHT = 0.01       # of the latest sample; the time constant is half a second
WINDOW = 5 * NS_PER_S


class Stamp(NamedTuple):
    """The stamp of an inertial sample, and its error."""

    time: float             # s since power-on, of the read
    error_us: float
    stamp: int
    read: int               # ROS time of the read


class Arrival:
    """The time of the read that completed the frame, as in most drivers."""

    def __call__(self, _device: int, arrival: int) -> int:
        """Return the raw time of a sample."""
        return arrival


class Average:
    """Device time plus an exponential moving average of its offset to arrival."""

    def __init__(self) -> None:
        """Start without a sample."""
        self._offset: float | None = None

    def __call__(self, device: int, arrival: int) -> int:
        """Return the raw time of a sample."""
        offset = arrival - device
        if self._offset is None:
            self._offset = offset
        self._offset += AVERAGE_WEIGHT * (offset - self._offset)
        return device + round(self._offset)


class WindowMinimum:
    """Device time plus the smallest offset to arrival of the last five seconds."""

    def __init__(self) -> None:
        """Start without a sample."""
        self._offsets: deque[tuple[int, int]] = deque()     # device time, ascending offset

    def __call__(self, device: int, arrival: int) -> int:
        """Return the raw time of a sample."""
        offsets, offset = self._offsets, arrival - device
        while offsets and offsets[-1][1] >= offset:
            offsets.pop()
        offsets.append((device, offset))
        while offsets[0][0] < device - WINDOW:
            offsets.popleft()
        return device + offsets[0][1]


OTHERS: dict[str, Callable[[], Callable[[int, int], int]]] = {
    'arrival': Arrival, 'moving average': Average, '5 s minimum': WindowMinimum}


def stamps_of_others(case: Case, seed: int) -> dict[str, list[Stamp]]:
    """Return the stamps of a case by the other methods."""
    simulation = Simulation(case, seed)
    methods = {name: make() for name, make in OTHERS.items()}
    stamps: dict[str, list[Stamp]] = {name: [] for name in methods}
    for now, _, messages in simulation.reads():
        offset = now.ros_ns - now.raw_ns
        for message, frame in messages:
            if isinstance(message, Inertial):
                for name, method in methods.items():
                    raw = method(simulation.device_times[frame.offset], now.raw_ns)
                    stamps[name].append(_stamp_of(simulation, now, frame, raw + offset))
    return stamps


def stamps_of_clock(case: Case, seed: int,
                    options: ClockOptions = ClockOptions()) -> tuple[list[Stamp], SampleClock]:
    """Return the stamps of a case by the clock of this driver, and the clock."""
    simulation, clock = Simulation(case, seed), SampleClock(ROLES, options)
    clock.begin(BYTE_TIME)
    stamps = []
    for now, received, messages in simulation.reads():
        clock.observe_read(now, received)
        stamps += stamps_of_read(simulation, now, clock.stamp(messages))
    return stamps, clock


def stamps_of_read(simulation: Simulation, now: Instant, stamped: list[Stamped]) -> list[Stamp]:
    """Return the stamps of the inertial samples of a read, with their errors."""
    return [_stamp_of(simulation, now, frame, stamp)
            for message, frame, stamp in stamped if isinstance(message, Inertial)]


def _stamp_of(simulation: Simulation, now: Any, frame: Frame, stamp: int) -> Stamp:
    truth = simulation.case.ros(simulation.truths[frame.offset])
    return Stamp((now.raw_ns - ORIGIN) / NS_PER_S, (stamp - truth) / 1000, stamp, now.ros_ns)
