# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The tasks that are about a BAHRS and its stream."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from bahrs_driver.diagnostics.device_task import DeviceTask
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.signals_task import SignalsTask
from bahrs_driver.diagnostics.task import Task
from bahrs_driver.protocol.bahrs.messages import SoftwareVersion
from bahrs_driver.protocol.integrity import Integrity

# Messages a second of a device of any version.
EXPECTED_RATES = {'inertial': 200.0, 'navigation': 100.0, 'accuracy': 10.0,
                  'navigation_time': 10.0, 'inertial_time': 10.0}


class BahrsHealth:
    """Watches the messages of a BAHRS."""

    def __init__(self, signals: Mapping[str, Integrity | None], rate_tolerance: float,
                 stale_timeout: float, nvm_status: Callable[[], str]) -> None:
        """Take the integrity of each signal, kept up to date by its owner, and the NVM's state."""
        self._rates = RatesTask(EXPECTED_RATES, rate_tolerance, stale_timeout)
        self._device = DeviceTask(self._rates.stale, nvm_status)
        self.tasks: Sequence[Task] = (
            self._rates, SignalsTask(signals, self._rates.stale), self._device)

    def observe(self, message: Any, now: float) -> None:
        """Take a message, received at a time in seconds (monotonic)."""
        if isinstance(message, SoftwareVersion):        # it is sent at power-on, and only then
            self._rates.restart()
        self._rates.observe(message, now)
        self._device.observe(message)

    def opened(self) -> None:
        """Begin another stream."""
        self._rates.restart()

    def stale(self, now: float) -> bool:
        """Return whether the data has ceased, at a time in seconds (monotonic)."""
        return self._rates.stale(now)

    @property
    def lost(self) -> int:
        """Messages lost since the start."""
        return sum(self._rates.lost.values())

    def device_id(self) -> str:
        """Return the name that the device gives itself; empty if it did not."""
        return self._device.device_id
