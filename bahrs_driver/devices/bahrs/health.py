# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics of a BAHRS and its stream."""

from collections.abc import Callable, Mapping

from bahrs_driver.devices.bahrs.device_task import DeviceTask
from bahrs_driver.diagnostics.integrity_task import IntegrityTask
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.stream_health import StreamHealth
from bahrs_driver.protocol.bahrs.messages import SoftwareVersion
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.message import Message

# Messages a second of a device of any version.
EXPECTED_RATES = {'inertial': 200.0, 'navigation': 100.0, 'accuracy': 10.0,
                  'navigation_time': 10.0, 'inertial_time': 10.0}


class BahrsHealth(StreamHealth):
    """Monitors the messages of a BAHRS; the converter keeps the integrity in signals current."""

    def __init__(self, signals: Mapping[str, Integrity | None], rate_tolerance: float,
                 stale_timeout: float) -> None:
        rates = RatesTask(EXPECTED_RATES, rate_tolerance, stale_timeout)
        self._device = DeviceTask(rates.stale)
        super().__init__(rates, IntegrityTask(signals, rates.stale), self._device)

    def watch_nvm(self, status: Callable[[], str]) -> None:
        """Show the status of the NVM session."""
        self._device.nvm_status = status

    def observe(self, message: Message, now: float) -> None:
        """Update the tasks with a message, received at a monotonic time in seconds."""
        if isinstance(message, SoftwareVersion):        # sent at power-on only
            self.restart()
        super().observe(message, now)
        self._device.observe(message)

    def device_id(self) -> str:
        """Return the identifier that the device reports; empty if it has not."""
        return self._device.device_id
