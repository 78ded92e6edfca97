# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface between an emulated device and its cable."""

from abc import ABC, abstractmethod
from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from typing import NamedTuple, Protocol

from bahrs_driver.emulator.measurement_errors import MeasurementErrors
from bahrs_driver.emulator.motion import Motion
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.protocol.integrity import Integrity


class Emission(NamedTuple):
    """
    A frame that a device sends.

    `ready` is the time at which the frame is ready for the line, `time` the time of the
    measurement, both true times in seconds. `truth` has the values without errors, by name.
    """

    ready: float
    data: bytes
    name: str
    truth: Mapping[str, object]
    time: float


class EmulatedDevice(ABC):
    """
    An emulated device. All times are true times, in seconds since the emulator started.

    A control command that the device does not support raises ValueError.
    """

    signals: tuple[str, ...] = ()       # signals whose integrity can be set

    @property
    @abstractmethod
    def next_time(self) -> float:
        """Time of the next step()."""

    @abstractmethod
    def step(self) -> list[Emission]:
        """Advance to next_time and return the frames that are sent then."""

    @abstractmethod
    def power_cycle(self, time: float) -> None:
        """Switch off and on again."""

    def receive(self, _data: bytes, _time: float) -> list[Emission]:
        """Receive bytes from the host and return the answers."""
        return []

    def set_integrity(self, _signals: tuple[str, ...], _integrity: Integrity) -> None:
        """Set the integrity of signals from the next sample on."""
        raise ValueError('this device reports no integrity')

    def set_drift(self, _ppm: float) -> None:
        """Set by how much the device clock runs faster than true time."""
        raise ValueError('this device reports no time of its own')

    def set_pulse_rate(self, _rate: float) -> None:
        """Set the rate of sync pulses in Hz; 0 is none."""
        raise ValueError('this device has no input for sync pulses')


class EmulatedDeviceFactory(Protocol):
    """Makes emulated devices of one kind from options of the command line."""

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Add the options that only this device has."""

    def make_device(self, options: Namespace, motion: Motion, errors: MeasurementErrors,
                    start_time: StartTime) -> EmulatedDevice:
        """Return an emulated device that is switched on at a host time."""
