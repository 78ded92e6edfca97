# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A Titan-M in simulated time. No I/O."""

from collections.abc import Mapping
from dataclasses import dataclass, field
import math
import random

from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.emulator.titan_m.measurements import TitanMeasurements
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.schedule import Schedule
from bahrs_driver.protocol.titan_m.frames import (
    build_answer,
    message_id,
    OrderChoice,
    request_of,
    REQUEST_SIZE,
    RequestFormat,
)
from bahrs_driver.protocol.titan_m.messages import ByteOrder, Sensors, TitanAnswer
from bahrs_driver.units import NS_PER_S


@dataclass(frozen=True)
class TitanBehavior:
    """Properties of a device; times in s."""

    payload_order: ByteOrder = 'little'
    checksum_order: ByteOrder = 'big'
    request_order: OrderChoice = 'auto'     # of the checksums that it accepts
    sensors_length: int = Sensors.LENGTHS[0]
    returns_id: bool = True                 # or always answers with id 0
    answer_delay: float = 0.0005            # from a request to its answer
    late_share: float = 0.0                 # of answers that take longer
    late_delay: float = 0.1
    start_up: float = 1.0                   # of silence after power-on
    first_fix: float = 0.0                  # after the start-up
    # Hz by kind of answer: sent without requests, because a file sends none.
    unrequested: Mapping[type[TitanAnswer], float] = field(default_factory=dict)


class TitanDevice(EmulatedDevice):
    """A Titan-M that is switched on at time 0."""

    def __init__(self, behavior: TitanBehavior, measurements: TitanMeasurements, byte_time: float,
                 seed: int = 1) -> None:
        self._behavior = behavior
        self._measurements = measurements
        self._request_time = REQUEST_SIZE * byte_time
        self._random = random.Random(f'late {seed}')
        self._schedule = Schedule(behavior.unrequested)
        self._schedule.start(0)
        self.power_cycle(0.0)

    @property
    def next_time(self) -> float:
        """Time of the next step(); infinite if the device only answers."""
        due = self._schedule.next_after(-1)
        return math.inf if due is None else due / NS_PER_S

    @property
    def skipped_bytes(self) -> int:
        """Count of bytes from the host that belong to no request."""
        return self._framer.counters.skipped_bytes

    def step(self) -> list[Emission]:
        """Advance to next_time and return the answers that are sent without a request."""
        time = self.next_time
        emissions = []
        for kind in self._schedule.due(round(time * NS_PER_S)):
            self._schedule.advance(kind, round(time * NS_PER_S))
            if time >= self._ready:
                emissions.append(self._answer(kind, 0, time))
        return emissions

    def receive(self, data: bytes, time: float) -> list[Emission]:
        """Receive bytes from the host and return the answers."""
        if time < self._ready:
            return []
        return [self._answer(request_of(frame).ANSWER, message_id(frame),
                             time + self._request_time)
                for frame in self._framer.feed(data)]

    def power_cycle(self, time: float) -> None:
        """Switch off and on again."""
        self._framer = Framer(RequestFormat(self._behavior.request_order))
        self._measurements.restart()
        self._ready = time + (self._behavior.start_up if time else 0.0)

    def _answer(self, kind: type[TitanAnswer], request_id: int, time: float) -> Emission:
        behavior = self._behavior
        has_fix = time >= self._ready + behavior.first_fix
        message, truth = self._measurements.measure(kind, time, has_fix)
        length = behavior.sensors_length if kind is Sensors else None
        frame = build_answer(message, request_id if behavior.returns_id else 0,
                             behavior.payload_order, behavior.checksum_order, length)
        late = behavior.late_share and self._random.random() < behavior.late_share
        return Emission(time + (behavior.late_delay if late else behavior.answer_delay), frame,
                        kind.NAME, truth, time)
