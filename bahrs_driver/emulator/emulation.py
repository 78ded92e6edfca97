# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A device at the far end of a cable, in simulated time. What a person may do to them is here."""

from collections import Counter
from collections.abc import Iterator
import math
from typing import NamedTuple

from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults

# What may become of a frame; overrun is one that the line was too slow for.
INTACT, DAMAGED, DROPPED = 'intact', 'damaged', 'dropped'
OVERRUN, UNPLUGGED = 'overrun', 'unplugged'


class Sent(NamedTuple):
    """A frame that the device sent, and what the cable made of it."""

    emission: Emission
    wire: str


class Emulation:
    """
    Device, faults and cable, moved on together. All times are true ones, in seconds.

    `counts` has the frames that were sent by name, `wire_counts` by what the cable made of them.
    """

    def __init__(self, device: EmulatedDevice, faults: Faults, cable: Cable) -> None:
        self.device = device
        self.faults = faults
        self.cable = cable
        self.counts: Counter[str] = Counter()
        self.wire_counts: Counter[str] = Counter()
        self.ended = False
        self._replug_time = -math.inf

    def advance(self, until: float) -> Iterator[Sent]:
        """Let the device do all that is due by then."""
        while self.device.next_time <= until:
            plugged = self.plugged(self.device.next_time)
            for emission in self.device.step():
                yield self._send(emission, plugged)

    def receive(self, data: bytes, now: float) -> Iterator[Sent]:
        """Hand the device what the host sent, through the same bad cable."""
        for emission in self.device.receive(self.faults.apply(data), now):
            yield self._send(emission, self.plugged(now))

    def take(self, now: float) -> bytes:
        """Return what has arrived at the host since the last call."""
        return self.cable.take(now)

    @property
    def next_time(self) -> float:
        """When there is something to do next."""
        return min(self.device.next_time, self.cable.next_time)

    def unplug(self, now: float, duration: float) -> None:
        """Pull the plug for some seconds; the device goes on, unheard."""
        self.cable.cut(now)
        self._replug_time = now + duration

    def plugged(self, now: float) -> bool:
        """Whether the plug is in."""
        return now >= self._replug_time

    def _send(self, emission: Emission, plugged: bool) -> Sent:
        wire = self._put_on_wire(emission) if plugged else UNPLUGGED
        self.counts[emission.name] += 1
        self.wire_counts[wire] += 1
        return Sent(emission, wire)

    def _put_on_wire(self, emission: Emission) -> str:
        data = self.faults.apply(emission.data)
        if not self.cable.send(emission.ready, data):
            return OVERRUN
        if emission.data in data:
            return INTACT
        return DAMAGED if data else DROPPED
