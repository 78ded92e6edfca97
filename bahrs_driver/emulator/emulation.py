# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A device at the far end of a cable, in simulated time."""

from collections import Counter
from collections.abc import Iterator
import math
from typing import NamedTuple

from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults

# Fates of a frame on the line. An overrun means that the line is too slow.
INTACT, DAMAGED, DROPPED = 'intact', 'damaged', 'dropped'
OVERRUN, UNPLUGGED = 'overrun', 'unplugged'


class SentFrame(NamedTuple):
    """A frame that the device sent, and its fate on the line."""

    emission: Emission
    fate: str


class Emulation:
    """
    Advances device, faults and cable together. All times are true times in seconds.

    `counts` counts the frames by name, `fate_counts` by their fate on the line.
    """

    def __init__(self, device: EmulatedDevice, faults: Faults, cable: Cable) -> None:
        self.device = device
        self.faults = faults
        self.cable = cable
        self.counts: Counter[str] = Counter()
        self.fate_counts: Counter[str] = Counter()
        self.ended = False
        self._replug_time = -math.inf

    def advance(self, until: float) -> Iterator[SentFrame]:
        """Advance the device to a time, and yield the frames that it sends."""
        device = self.device
        while (time := device.next_time) <= until:
            plugged = self.plugged(time)
            for emission in device.step():
                yield self._send(emission, plugged)

    def receive(self, data: bytes, now: float) -> Iterator[SentFrame]:
        """Pass bytes of the host to the device through the same faulty cable."""
        for emission in self.device.receive(self.faults.apply(data), now):
            yield self._send(emission, self.plugged(now))

    def take(self, now: float) -> bytes:
        """Return the bytes that have arrived at the host since the last call."""
        return self.cable.take(now)

    @property
    def next_time(self) -> float:
        """Time of the next event."""
        return min(self.device.next_time, self.cable.next_time)

    def unplug(self, now: float, duration: float) -> None:
        """Unplug the cable for some seconds; the device continues."""
        self.cable.unplug(now)
        self._replug_time = now + duration

    def plugged(self, now: float) -> bool:
        """Return whether the cable is plugged in."""
        return now >= self._replug_time

    def _send(self, emission: Emission, plugged: bool) -> SentFrame:
        fate = self._transmit(emission) if plugged else UNPLUGGED
        self.counts[emission.name] += 1
        self.fate_counts[fate] += 1
        return SentFrame(emission, fate)

    def _transmit(self, emission: Emission) -> str:
        """Send a frame through faults and cable, and return its fate."""
        data = self.faults.apply(emission.data)
        if not self.cable.send(emission.ready, data):
            return OVERRUN
        if data is emission.data or emission.data in data:
            return INTACT
        return DAMAGED if data else DROPPED
