# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A BAHRS in simulated time. No I/O."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
import struct
from typing import Literal

from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceBehavior
from bahrs_driver.emulator.bahrs.pulses import Pulses
from bahrs_driver.emulator.bahrs.stream import (
    BahrsStream,
    INERTIAL_PERIOD_US,
    SIGNALS,
    SimulatedMessage,
    TimeLabel,
    with_own_time,
)
from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.emulator.device_clock import DeviceClock
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, build_frame, CrcOrder
from bahrs_driver.protocol.bahrs.messages import (
    BahrsMessage,
    HardwareVersion,
    SoftwareVersion,
    SyncPulseTime,
)
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.units import COUNTER_MODULUS, US_PER_S

SOFTWARE = SoftwareVersion('EMU', 1, 0)
ANSWER_DELAY = 0.002        # s, on the line and in the device
HARDWARE = HardwareVersion(0x0450, (0x00330041, 0x3131510B, 0x38363333))


@dataclass(frozen=True)
class StartUp:
    """Device time of the first sample, and a pause before the sample with a given count."""

    first_sample_us: int
    pause_us: int = 0
    pause_before: int = 0


START_UPS = {
    'prompt': StartUp(600_000),
    # The recording's second time message, at sample 20, is 2,800,037 us after its first.
    'recorded': StartUp(2_581_377, 2_800_037 - 20 * INERTIAL_PERIOD_US, 16),
}


@dataclass(frozen=True)
class BahrsBehavior:
    """Properties of a device."""

    version: int = 3
    crc: CrcOrder = 'word'
    time_label: TimeLabel = 'next'
    start_up: Literal['prompt', 'recorded'] = 'prompt'
    debug_rate: float = 0.0         # Hz, up to 200, of the undocumented messages 0xC0 and 0xC1
    output_delay: float = 0.0       # s, from a sample to its first byte
    service: ServiceBehavior = ServiceBehavior()


class BahrsDevice(EmulatedDevice):
    """A BAHRS that is switched on at time 0."""

    signals = SIGNALS

    def __init__(self, behavior: BahrsBehavior, motion: Motion, errors: MeasurementErrors,
                 clock: DeviceClock, pulses: Pulses) -> None:
        self.clock = clock
        self.pulses = pulses
        self.stream = BahrsStream(behavior.version, behavior.time_label, errors)
        self._behavior = behavior
        self._motion = motion
        self._codec = BahrsCodec()
        self._start_up = START_UPS[behavior.start_up]
        self._diagnostics = DiagnosticsMode(behavior.service)
        self.power_cycle(0.0)

    @property
    def next_time(self) -> float:
        """Time of the next step()."""
        return self._power_on if self._booting else self.clock.time

    def power_cycle(self, time: float) -> None:
        """Switch off and on again."""
        self.clock.restart(time)
        self.stream.restart()
        self._diagnostics.restart(time)
        self._power_on = time
        self._booting = True
        self._pulse_count = 0

    def set_drift(self, ppm: float) -> None:
        """Set by how much the device clock runs faster than true time."""
        self.clock.drift_ppm = ppm

    def set_pulse_rate(self, rate: float) -> None:
        """Set the rate of sync pulses in Hz; 0 is none."""
        self.pulses.rate = rate

    def set_integrity(self, signals: tuple[str, ...], integrity: Integrity) -> None:
        """Set the integrity of signals from the next sample on."""
        self.stream.set_integrity(signals, integrity)

    def step(self) -> list[Emission]:
        """Advance to next_time and return the frames that are sent then."""
        if self._booting:
            self._booting = False
            return self._boot()
        time, reading = self.clock.time, self.clock.reading_us
        if self._diagnostics.active(time):
            self.pulses.skip_until(time)
            self.clock.advance(INERTIAL_PERIOD_US)
            return []
        messages = self.stream.sample(self._motion.at(time), reading)
        emissions = self._emissions(messages, time, time)
        pulse = self.pulses.take_latest(time)
        if pulse is not None:
            emissions += self._emissions([self._pulse_message(pulse)], time, pulse)
        if self._behavior.debug_rate:
            emissions += self._debug_frames(time, reading)
        self._advance_clock()
        return emissions

    def receive(self, data: bytes, time: float) -> list[Emission]:
        """Receive bytes from the host and return the answers."""
        return [self._answer(message, time)
                for message in self._diagnostics.receive(data, time)]

    def _answer(self, message: BahrsMessage, time: float) -> Emission:
        behavior = self._behavior
        frame = self._codec.encode(message, behavior.version, behavior.service.checksum)
        return Emission(time + ANSWER_DELAY, frame, message.NAME, {}, time)

    def _boot(self) -> list[Emission]:
        """Return the version messages, and advance the clock to the first sample."""
        versions = [SOFTWARE, HARDWARE] if self._behavior.version >= HARDWARE.SINCE else [SOFTWARE]
        truth = {'device_time_us': self.clock.reading_us}
        messages: list[SimulatedMessage] = [(message, truth) for message in versions]
        self.clock.advance(self._start_up.first_sample_us)
        self.pulses.skip_until(self.clock.time)
        return self._emissions(messages, self._power_on, self._power_on)

    def _advance_clock(self) -> None:
        """Advance the clock to the next sample."""
        start_up = self._start_up
        pause = start_up.pause_us if self.stream.count == start_up.pause_before else 0
        self.clock.advance(INERTIAL_PERIOD_US + pause)

    def _pulse_message(self, pulse: float) -> SimulatedMessage:
        sequence = self._pulse_count % COUNTER_MODULUS
        self._pulse_count += 1
        return with_own_time(SyncPulseTime(sequence, self.clock.reading_at(pulse)))

    def _emissions(self, messages: Iterable[SimulatedMessage], sent: float,
                   time: float) -> list[Emission]:
        behavior, encode = self._behavior, self._codec.encode
        version, crc, ready = behavior.version, behavior.crc, sent + behavior.output_delay
        return [Emission(ready, encode(message, version, crc), message.NAME, truth, time)
                for message, truth in messages]

    def _debug_frames(self, time: float, reading: int) -> Iterator[Emission]:
        rate = self._behavior.debug_rate
        if self.stream.count % round(US_PER_S / INERTIAL_PERIOD_US / rate):
            return
        text = b'emulated debug output'
        contents = {0xC0: struct.pack('<BQH', 1, reading, len(text)) + text,
                    0xC1: struct.pack('<BQ', 1, reading)}
        for kind, payload in contents.items():
            frame = build_frame(self._behavior.version, kind, payload, self._behavior.crc)
            yield Emission(time + self._behavior.output_delay, frame, f'debug_{kind:02x}',
                           {'device_time_us': reading}, time)
