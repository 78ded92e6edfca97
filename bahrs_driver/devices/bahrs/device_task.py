# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics task *Device* of a BAHRS: versions and identifier."""

from collections.abc import Callable, Mapping
from typing import Any

from bahrs_driver.diagnostics.task import NO_DATA, OK, STALE, Staleness, Verdict, WARN
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.bahrs.messages import HardwareVersion, Navigation, SoftwareVersion

# Below any aircraft: a pressure height above 4,500 m, read as int16, falls here.
IMPOSSIBLE_HEIGHT = -1000.0         # m


class DeviceTask:
    """Reports versions and identifier of the device, and an implausible pressure height."""

    name = 'Device'

    def __init__(self, stale: Staleness) -> None:
        self.nvm_status: Callable[[], str] = lambda: 'none'     # of the session on the port
        self._stale = stale
        self._software: SoftwareVersion | None = None
        self._hardware: HardwareVersion | None = None
        self._impossible_height = False

    def observe(self, message: Any) -> None:
        """Store what a message reports of the device."""
        if isinstance(message, SoftwareVersion):
            self._software = message
        elif isinstance(message, HardwareVersion):
            self._hardware = message
        elif isinstance(message, Navigation):
            self._impossible_height = (message.health[0].available
                                       and message.pressure_height < IMPOSSIBLE_HEIGHT)

    @property
    def device_id(self) -> str:
        """Project code, if known, and unique number of the microcontroller; empty without one."""
        if self._hardware is None:
            return ''
        project = f'{printable(self._software.project)}-' if self._software else ''
        return project + _words(self._hardware)

    def judge(self, now: float) -> Verdict:
        """Return the version, or a warning about an implausible pressure height."""
        if self._stale(now):
            return Verdict(STALE, NO_DATA)
        if self._impossible_height:
            return Verdict(WARN, f'The pressure height is below {IMPOSSIBLE_HEIGHT:.0f} m: '
                                 'is pressure_height.format right? Devices send uint16')
        if self._software is None:
            return Verdict(OK, 'No version heard: the device tells it only at power-on')
        return Verdict(OK, self._version(self._software))

    def values(self, now: float) -> Mapping[str, str]:
        """Return versions, identifier and NVM session."""
        values = dict.fromkeys(
            ('Device id', 'Software version', 'MCU', 'MCU unique number'), 'not heard')
        if self._software:
            values['Software version'] = self._version(self._software)
        if self._hardware:
            values['Device id'] = self.device_id
            values['MCU'] = f'0x{self._hardware.mcu_id:04X}'
            values['MCU unique number'] = _words(self._hardware)
        values['NVM session'] = self.nvm_status()
        return values

    @staticmethod
    def _version(software: SoftwareVersion) -> str:
        return f'{printable(software.project)} {software.major}.{software.minor}'


def _words(hardware: HardwareVersion) -> str:
    return ''.join(f'{word:08X}' for word in hardware.unique_id)
