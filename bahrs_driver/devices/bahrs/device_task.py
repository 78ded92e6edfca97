# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics task *Device* of a BAHRS: versions and identifier."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import NO_DATA, OK, Staleness, Status, Template, WARN
from bahrs_driver.process.printable import printable
from bahrs_driver.protocol.bahrs.messages import HardwareVersion, Navigation, SoftwareVersion
from bahrs_driver.protocol.message import Message

# No aircraft is lower, but a pressure height above 4,500 m is if it is read as int16.
LEAST_HEIGHT = -1000.0              # m

WRONG_HEIGHT = Template(WARN, f'The pressure height is below {LEAST_HEIGHT:.0f} m: is '
                              'pressure_height.format right? Devices send uint16',
                        'a height read with the wrong sign')
NO_VERSION = Template(OK, 'No version received: the device sends it only at power-on')
VERSION = Template(OK, '{version}')


class DeviceTask:
    """Reports versions and identifier of the device, and an implausible pressure height."""

    name = 'Device'
    messages = WRONG_HEIGHT, NO_DATA, NO_VERSION, VERSION

    def __init__(self, stale: Staleness) -> None:
        self.nvm_status: Callable[[], str] = lambda: 'none'     # of the session on the port
        self._stale = stale
        self._software: SoftwareVersion | None = None
        self._hardware: HardwareVersion | None = None
        self._wrong_height = False

    def observe(self, message: Message) -> None:
        """Remember the versions, and check the height, in a message."""
        if isinstance(message, Navigation):
            self._wrong_height = (message.pressure_height < LEAST_HEIGHT
                                  and message.health[0].available)
        elif isinstance(message, SoftwareVersion):
            self._software = message
        elif isinstance(message, HardwareVersion):
            self._hardware = message

    @property
    def device_id(self) -> str:
        """Project code, if known, and unique number of the microcontroller; empty without one."""
        if self._hardware is None:
            return ''
        project = f'{printable(self._software.project)}-' if self._software else ''
        return project + _unique_number(self._hardware)

    def run(self, status: Status) -> Status:
        """Report the version, or that the data is not plausible."""
        status.values_from(self._values)
        if self._stale(status.now):
            return status.summary(NO_DATA)
        if self._wrong_height:
            return status.summary(WRONG_HEIGHT)
        if self._software is None:
            return status.summary(NO_VERSION)
        return status.summary(VERSION, version=_version(self._software))

    def _values(self, _now: float) -> Mapping[str, str]:
        values = dict.fromkeys(
            ('Device id', 'Software version', 'MCU', 'MCU unique number'), 'not received')
        if self._software:
            values['Software version'] = _version(self._software)
        if self._hardware:
            values['Device id'] = self.device_id
            values['MCU'] = f'0x{self._hardware.mcu_id:04X}'
            values['MCU unique number'] = _unique_number(self._hardware)
        values['NVM session'] = self.nvm_status()
        return values


def _version(software: SoftwareVersion) -> str:
    return f'{printable(software.project)} {software.major}.{software.minor}'


def _unique_number(hardware: HardwareVersion) -> str:
    return ''.join(f'{word:08X}' for word in hardware.unique_id)
