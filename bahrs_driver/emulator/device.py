# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the cable must know of an emulated device, whichever it is."""

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

from bahrs_driver.protocol.integrity import Integrity


class Emission(NamedTuple):
    """
    A frame that a device sends.

    `ready` is when it is ready to go on the line and `time` when what it tells was so, both true
    times in seconds. `truth` has the values without any error, by name.
    """

    ready: float
    data: bytes
    name: str
    truth: Mapping[str, Any]
    time: float


class Device(Protocol):
    """An emulated device. All times are true ones, in seconds since the emulator started."""

    @property
    def next_time(self) -> float:
        """When step() is due."""

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals whose integrity can be set."""

    def step(self) -> list[Emission]:
        """Do what is due at next_time, and return what is sent then."""

    def receive(self, data: bytes, time: float) -> list[Emission]:
        """Take what the host sent, and return the answers."""

    def power_cycle(self, time: float) -> None:
        """Switch off and on again."""

    def set_integrity(self, signals: tuple[str, ...], integrity: Integrity) -> None:
        """Declare what signals are worth from the next sample on."""

    def set_drift(self, ppm: float) -> None:
        """Change how much faster than true time the device's clock runs."""

    def set_pulse_rate(self, rate: float) -> None:
        """Change the rate of sync pulses, in Hz; 0 is none."""
