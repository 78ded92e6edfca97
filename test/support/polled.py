# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""An emulated Titan-M and the driver's parts that poll it, in simulated time."""

from typing import Any

from bahrs_driver.clock import ExchangeClock, Instant, Stamped
from bahrs_driver.emulator.emulation import Emulation, SentFrame
from bahrs_driver.emulator.flights import Still
from bahrs_driver.emulator.ground_path import GroundPath
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.emulator.titan_m.device import TitanBehavior, TitanDevice
from bahrs_driver.emulator.titan_m.measurements import TitanMeasurements
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.decoder import TitanDecoder
from bahrs_driver.protocol.titan_m.frames import Answer, AnswerFormat, REQUEST_SIZE
from bahrs_driver.protocol.titan_m.messages import (
    GpsRequest,
    SensorsRequest,
    StateRequest,
    TitanAnswer,
)
from bahrs_driver.protocol.titan_m.poller import Poller, PollOptions
from bahrs_driver.units import BITS_PER_BYTE, byte_time_ns
from bahrs_driver.virtual_serial.cable import AT_ONCE, Cable
from bahrs_driver.virtual_serial.faults import Faults

BAUD_RATE = 115200
NS = 10 ** 9
RATES = {SensorsRequest: 50.0, StateRequest: 50.0, GpsRequest: 10.0}
HOST_LATENCY = 0.0003       # s, from when something can be done until the host does it


def make_titan(motion: Motion | None = None, start: tuple[float, float] = (47.0, 11.0),
               errors: MeasurementErrors | None = None, seed: int = 1,
               **behavior: Any) -> TitanDevice:
    """Return a device that is at rest and measures without error by default."""
    measurements = TitanMeasurements(GroundPath(motion or Still(), *start),
                                     errors or MeasurementErrors(seed))
    return TitanDevice(TitanBehavior(**behavior), measurements, BITS_PER_BYTE / BAUD_RATE, seed)


class _RecordingDecoder(TitanDecoder):
    """Decode answers, and record when each was requested."""

    def __init__(self, payloads: PayloadDecoder[Stamped], poller: Poller,
                 requested: dict[int, int]) -> None:
        super().__init__(payloads, poller)
        self._requested = requested

    def decode(self, frame: Frame, now: int) -> Answer:
        """Record the time of the request."""
        answer = super().decode(frame, now)
        if answer.requested_at is not None:
            self._requested[frame.offset] = answer.requested_at
        return answer


class PolledDevice:
    """
    A device on a cable, and what polls and reads it, with time that passes only when told.

    `sent` has all frames of the device, `received` all decoded and all unexpected answers with the
    time (s) at which each was read, `requested` the time (ns) of the request for each by its
    offset in the stream, `chunks` the bytes of each read with its time.
    """

    def __init__(self, device: TitanDevice | None = None, rates: Any = None, seed: int = 1,
                 mode: str | float = AT_ONCE, faults: dict[str, float] | None = None,
                 options: PollOptions = PollOptions()) -> None:
        """Put the parts together, at time 0."""
        self.device = device or make_titan()
        self.emulation = Emulation(self.device, Faults(seed, faults or {}),
                                   Cable(BAUD_RATE, mode))
        self.format = AnswerFormat()
        self.poller = Poller(rates or RATES, self.format, options)
        self.requested: dict[int, int] = {}
        self.pipeline = Pipeline(Framer(self.format), _RecordingDecoder(
            PayloadDecoder(), self.poller, self.requested), ExchangeClock(REQUEST_SIZE))
        self.sent: list[SentFrame] = []
        self.received: list[tuple[float, Stamped]] = []
        self.chunks: list[tuple[float, bytes]] = []
        self.asked_bytes = 0
        self.now = 0.0
        self.pipeline.open(byte_time_ns(BAUD_RATE))

    def run(self, until: float) -> None:
        """Let everything happen up to a time in seconds."""
        while (due := self._next_time()) <= until:
            # The host is never on the spot.
            self.now = max(self.now, due) + HOST_LATENCY
            self.sent += self.emulation.advance(self.now)
            self._read(self.emulation.take(self.now))
            self._ask()

    def _next_time(self) -> float:
        due = self.poller.due(round(self.now * NS))
        return min(self.emulation.next_time, float('inf') if due is None else due / NS)

    def _read(self, data: bytes) -> None:
        if not data:
            return
        self.chunks.append((self.now, data))
        time = round(self.now * NS)
        events = self.pipeline.feed(data, Instant(time, time))
        for event in events:
            assert isinstance(event, Stamped), event
            message = event.message
            if isinstance(message, TitanAnswer) or (
                    isinstance(message, Answer) and not message.expected):
                self.received.append((self.now, event))

    def _ask(self) -> None:
        while data := self.poller.send(round(self.now * NS)):
            self.asked_bytes += len(data)
            self.sent += self.emulation.receive(data, self.now)
