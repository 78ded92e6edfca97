# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Emulated devices for tests, put together in one call, and what they send, decoded."""

from typing import Any

from bahrs_driver.emulator.bahrs.device import BahrsBehavior, BahrsDevice
from bahrs_driver.emulator.bahrs.pulses import Pulses
from bahrs_driver.emulator.device import Emission
from bahrs_driver.emulator.device_clock import DeviceClock
from bahrs_driver.emulator.emulation import Emulation, SentFrame
from bahrs_driver.emulator.flights import Still
from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import BahrsMessage
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.virtual_serial.cable import AT_ONCE, Cable
from bahrs_driver.virtual_serial.faults import Faults

BAUD_RATE = 115200


def make_device(motion: Motion | None = None, seed: int = 1,
                errors: MeasurementErrors | None = None,
                drift_ppm: float = 0.0, wander_ppm: float = 0.0, pulse_rate: float = 0.0,
                **behavior: Any) -> BahrsDevice:
    """Return a device that is at rest and measures without error by default."""
    return BahrsDevice(BahrsBehavior(**behavior), motion or Still(),
                       errors or MeasurementErrors(seed),
                       DeviceClock(seed, drift_ppm, wander_ppm), Pulses(pulse_rate))


def make_emulation(device: BahrsDevice | None = None, seed: int = 1,
                   mode: str | float = AT_ONCE, **rates: float) -> Emulation:
    """Return a device on a cable with faults at the given rates."""
    faults = Faults(seed, {name.rstrip('_'): rate for name, rate in rates.items()})
    return Emulation(device or make_device(), faults, Cable(BAUD_RATE, mode))


def emissions(device: BahrsDevice, until: float) -> list[Emission]:
    """Return all that a device sends up to a time in seconds."""
    sent = []
    while device.next_time <= until:
        sent += device.step()
    return sent


def on_the_wire(emulation: Emulation, until: float) -> tuple[list[SentFrame], bytes]:
    """Return what was sent up to a time in seconds, and the bytes that came of it."""
    sent = list(emulation.advance(until))
    return sent, emulation.take(until + 10.0)


def decoded(data: bytes) -> list[BahrsMessage]:
    """Return the messages in a stream."""
    framer, codec = Framer(BahrsFormat()), BahrsCodec()
    return [codec.decode(frame) for frame in framer.feed(data) + framer.flush()]
