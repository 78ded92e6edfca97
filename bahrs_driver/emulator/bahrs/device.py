# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A BAHRS in simulated time: when it samples, what it sends, what it answers. No I/O."""

from collections.abc import Iterator
from dataclasses import dataclass
import struct
from typing import Literal

from bahrs_driver.emulator.bahrs.diagnostics_mode import DiagnosticsMode, ServiceHabits
from bahrs_driver.emulator.bahrs.pulses import Pulses
from bahrs_driver.emulator.bahrs.stream import (
    BahrsStream,
    INERTIAL_PERIOD_US,
    Said,
    SIGNALS,
    TimeLabel,
)
from bahrs_driver.emulator.device import Emission, EmulatedDevice
from bahrs_driver.emulator.device_clock import DeviceClock
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.emulator.noise import Noise
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
ANSWER_DELAY = 0.002        # s, the request's time on the line and the device's own
HARDWARE = HardwareVersion(0x0450, (0x00330041, 0x3131510B, 0x38363333))


@dataclass(frozen=True)
class StartUp:
    """Device time of the first sample, and of a pause before the sample with a given count."""

    first_sample_us: int
    pause_us: int = 0
    pause_before: int = 0


START_UPS = {
    'prompt': StartUp(600_000),
    # The recording's second time message, at sample 20, is 2,800,037 us after its first.
    'recorded': StartUp(2_581_377, 2_800_037 - 20 * INERTIAL_PERIOD_US, 16),
}


@dataclass(frozen=True)
class BahrsHabits:
    """What differs between one BAHRS and another."""

    version: int = 3
    crc: CrcOrder = 'word'
    time_label: TimeLabel = 'next'
    start_up: Literal['prompt', 'recorded'] = 'prompt'
    debug_rate: float = 0.0         # Hz, up to 200, of the undocumented messages 0xC0 and 0xC1
    output_delay: float = 0.0       # s, from a sample to the first byte that tells of it
    service: ServiceHabits = ServiceHabits()


class BahrsDevice(EmulatedDevice):
    """A BAHRS that is on from time 0. All times are true ones, in seconds."""

    signals = SIGNALS

    def __init__(self, habits: BahrsHabits, motion: Motion, noise: Noise,
                 clock: DeviceClock, pulses: Pulses) -> None:
        self.clock = clock
        self.pulses = pulses
        self.stream = BahrsStream(habits.version, habits.time_label, noise)
        self._habits = habits
        self._motion = motion
        self._codec = BahrsCodec()
        self._start_up = START_UPS[habits.start_up]
        self._diagnostics = DiagnosticsMode(habits.service)
        self.power_cycle(0.0)

    @property
    def next_time(self) -> float:
        """When step() is due."""
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
        """Change how much faster than true time the device's clock runs."""
        self.clock.drift_ppm = ppm

    def set_pulse_rate(self, rate: float) -> None:
        """Change the rate of sync pulses, in Hz; 0 is none."""
        self.pulses.rate = rate

    def set_integrity(self, signals: tuple[str, ...], integrity: Integrity) -> None:
        """Declare what signals are worth from the next sample on."""
        self.stream.set_integrity(signals, integrity)

    def step(self) -> list[Emission]:
        """Do what is due at next_time, and return what is sent then."""
        if self._booting:
            self._booting = False
            return list(self._boot())
        time, reading = self.clock.time, self.clock.reading_us
        if self._diagnostics.active(time):
            self.pulses.skip_until(time)
            self.clock.advance(INERTIAL_PERIOD_US)
            return []
        said = [*self.stream.sample(self._motion.at(time), reading), *self._pulse(time)]
        emissions = [self._emission(item, time, reading) for item in said]
        emissions += self._debug(time, reading)
        self._wait_for_next_sample()
        return emissions

    def receive(self, data: bytes, time: float) -> list[Emission]:
        """Take what the host sent, and return the answers."""
        return [self._service(message, time)
                for message in self._diagnostics.receive(data, time)]

    def _service(self, message: BahrsMessage, time: float) -> Emission:
        habits = self._habits
        frame = self._codec.encode(message, habits.version, habits.service.checksum)
        return Emission(time + ANSWER_DELAY, frame, message.NAME, {}, time)

    def _boot(self) -> Iterator[Emission]:
        versions = [SOFTWARE, HARDWARE] if self._habits.version >= HARDWARE.SINCE else [SOFTWARE]
        for message in versions:
            yield self._emission(Said(message), self._power_on, self.clock.reading_us)
        self.clock.advance(self._start_up.first_sample_us)
        self.pulses.skip_until(self.clock.time)

    def _wait_for_next_sample(self) -> None:
        start_up = self._start_up
        pause = start_up.pause_us if self.stream.count == start_up.pause_before else 0
        self.clock.advance(INERTIAL_PERIOD_US + pause)

    def _pulse(self, time: float) -> Iterator[Said]:
        pulse = self.pulses.latest(time)
        if pulse is not None:
            sequence = self._pulse_count % COUNTER_MODULUS
            yield Said(SyncPulseTime(sequence, self.clock.reading_at(pulse)),
                       time=pulse)
            self._pulse_count += 1

    def _emission(self, said: Said, time: float, reading: int) -> Emission:
        message, habits = said.message, self._habits
        frame = self._codec.encode(message, habits.version, habits.crc)
        truth = {'device_time_us': getattr(message, 'device_time_us', reading), **said.truth}
        if hasattr(message, 'sequence'):
            truth['sequence'] = message.sequence
        return Emission(time + habits.output_delay, frame, message.NAME, truth,
                        time if said.time is None else said.time)

    def _debug(self, time: float, reading: int) -> Iterator[Emission]:
        rate = self._habits.debug_rate
        if not rate or self.stream.count % round(US_PER_S / INERTIAL_PERIOD_US / rate):
            return
        text = b'emulated debug output'
        contents = {0xC0: struct.pack('<BQH', 1, reading, len(text)) + text,
                    0xC1: struct.pack('<BQ', 1, reading)}
        for kind, payload in contents.items():
            frame = build_frame(self._habits.version, kind, payload, self._habits.crc)
            yield Emission(time + self._habits.output_delay, frame, f'debug_{kind:02x}',
                           {'device_time_us': reading}, time)
