# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The messages of the BAHRS, protocol versions 1 to 3, one row for each field.

Values are SI: metres, seconds (device time in whole microseconds), radians, m/s, m/s^2. Vectors
and attitude are in the axes of the device: body axes forward, right, down; navigation axes north,
east, down. A field has a value even if its signal is not available; `health` has the integrity.
Section numbers refer to the BAHRS serial protocol document 2.0.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Literal

from bahrs_driver.protocol.integrity import Health
from bahrs_driver.protocol.layout import (
    block,
    deviation,
    integer,
    integers,
    integrity_fields,
    Layout,
    scaled,
    text,
    valid_flags,
    Vector,
    vector,
    wire,
)
from bahrs_driver.protocol.message import Message

VERSIONS = (1, 2, 3)

ANGLE = 9.587526e-5         # rad
HEIGHT = 0.16784924         # m
HEIGHT_OFFSET = -1000.0     # m
VELOCITY = 9.155413e-3      # m/s
FORCE, FORCE_2 = 1.4964e-3, 1.495384e-3         # m/s^2, from version 3 and before
RATE, RATE_2 = 1.5979452e-4, 1.597921e-4        # rad/s, from version 3 and before

HeightFormat = Literal['uint16', 'int16']
_HEIGHT_ROWS = {
    'uint16': scaled('H', HEIGHT, 'm', HEIGHT_OFFSET),
    'int16': scaled('h', HEIGHT, 'm', HEIGHT_OFFSET),
}


class BahrsMessage(Message):
    """A message of a BAHRS: its type on the wire, and its first protocol version."""

    __slots__ = ()
    TYPE: ClassVar[int]
    SINCE: ClassVar[int] = 1


@dataclass(frozen=True, slots=True)
class Inertial(BahrsMessage):
    """
    Specific force and angular rate about the body axes (0x01, section 3.1).

    `health` has six signals: specific force x, y, z, angular rate x, y, z.
    """

    TYPE: ClassVar[int] = 0x01
    NAME: ClassVar[str] = 'inertial'
    SIGNALS: ClassVar[tuple[str, ...]] = (
        'specific_force_x', 'specific_force_y', 'specific_force_z',
        'angular_rate_x', 'angular_rate_y', 'angular_rate_z')

    sequence: int = wire(integer('B'))
    specific_force: Vector = wire({1: vector('h', FORCE_2, 'm/s^2'),
                                   3: vector('h', FORCE, 'm/s^2')})
    angular_rate: Vector = wire({1: vector('h', RATE_2, 'rad/s'), 3: vector('h', RATE, 'rad/s')})
    health: Health = wire({1: valid_flags('B', 6), 3: integrity_fields('H', 6)})


@dataclass(frozen=True, slots=True)
class Navigation(BahrsMessage):
    """
    Pressure height, vertical velocity and attitude (0x02, section 3.2).

    Height is above the 1013.25 hPa level of the standard atmosphere. The magnetic heading is 0
    to 2 pi, in version 1 -pi to pi. `health` has five signals, in the order of the fields.
    """

    TYPE: ClassVar[int] = 0x02
    NAME: ClassVar[str] = 'navigation'
    SIGNALS: ClassVar[tuple[str, ...]] = (
        'pressure_height', 'velocity_down', 'roll', 'pitch', 'magnetic_heading')

    sequence: int = wire(integer('B'))
    pressure_height: float = wire(_HEIGHT_ROWS['uint16'])
    velocity_down: float = wire(scaled('h', VELOCITY, 'm/s'))
    roll: float = wire(scaled('h', ANGLE, 'rad'))
    pitch: float = wire(scaled('h', ANGLE, 'rad'))
    magnetic_heading: float = wire({1: scaled('h', ANGLE, 'rad'), 2: scaled('H', ANGLE, 'rad')})
    health: Health = wire({1: valid_flags('B', 5), 3: integrity_fields('H', 5)})


@dataclass(frozen=True, slots=True)
class Accuracy(BahrsMessage):
    """
    Standard deviations of the attitude, as rotations about north, east, down (0x03, section 3.3).

    None is invalid. In version 1 the third value belongs to the attitude about the down axis
    instead of the magnetic heading.
    """

    TYPE: ClassVar[int] = 0x03
    NAME: ClassVar[str] = 'accuracy'

    sequence: int = wire(integer('B'))
    north_std: float | None = wire(deviation('H', ANGLE, 'rad'))
    east_std: float | None = wire(deviation('H', ANGLE, 'rad'))
    heading_std: float | None = wire(deviation('H', ANGLE, 'rad'))
    device_time_us: int = wire(integer('Q', 'us'))


@dataclass(frozen=True, slots=True)
class TimeMessage(BahrsMessage):
    """Relates the sequence number of a data message to device time."""

    PROPERTIES: ClassVar[tuple[str, ...]] = ('valid',)

    sequence: int = wire(integer('B'))
    reference_sequence: int = wire(integer('B'))
    device_time_us: int = wire(integer('Q', 'us'))

    @property
    def valid(self) -> bool:
        """Whether the device has a time; both fields are zero if not."""
        return bool(self.reference_sequence or self.device_time_us)


class NavigationTime(TimeMessage):
    """Device time of a navigation message, named by its sequence number (0x04, section 3.4)."""

    __slots__ = ()
    TYPE: ClassVar[int] = 0x04
    NAME: ClassVar[str] = 'navigation_time'


class InertialTime(TimeMessage):
    """Device time of an inertial message, named by its sequence number (0x05, section 3.5)."""

    __slots__ = ()
    TYPE: ClassVar[int] = 0x05
    NAME: ClassVar[str] = 'inertial_time'


@dataclass(frozen=True, slots=True)
class SyncPulseTime(BahrsMessage):
    """Device time of the latest synchronisation pulse (0x06, section 3.6)."""

    TYPE: ClassVar[int] = 0x06
    NAME: ClassVar[str] = 'sync_pulse_time'

    sequence: int = wire(integer('B'))
    device_time_us: int = wire(integer('Q', 'us'))


@dataclass(frozen=True, slots=True)
class SoftwareVersion(BahrsMessage):
    """Project code and software version, sent once after power-on (0x0F, section 3.7)."""

    TYPE: ClassVar[int] = 0x0F
    NAME: ClassVar[str] = 'software_version'

    project: str = wire(text(3))
    major: int = wire(integer('H'))
    minor: int = wire(integer('H'))


@dataclass(frozen=True, slots=True)
class HardwareVersion(BahrsMessage):
    """Type and 96-bit unique number of the microcontroller (0x1F, section 3.8)."""

    TYPE: ClassVar[int] = 0x1F
    NAME: ClassVar[str] = 'hardware_version'
    SINCE: ClassVar[int] = 3

    mcu_id: int = wire(integer('H'))
    unique_id: tuple[int, int, int] = wire(integers('I', 3))


@dataclass(frozen=True, slots=True)
class EnterDiagnostics(BahrsMessage):
    """Host to device: enter diagnostics mode, which stops all other output (0xF0, section 5.1)."""

    TYPE: ClassVar[int] = 0xF0
    NAME: ClassVar[str] = 'enter_diagnostics'
    SERVICE: ClassVar[bool] = True


@dataclass(frozen=True, slots=True)
class ExitDiagnostics(BahrsMessage):
    """Host to device: leave diagnostics mode (0xF1, section 5.2)."""

    TYPE: ClassVar[int] = 0xF1
    NAME: ClassVar[str] = 'exit_diagnostics'
    SERVICE: ClassVar[bool] = True


@dataclass(frozen=True, slots=True)
class NvmReadRequest(BahrsMessage):
    """Host to device: read one of the 250 pages of the non-volatile memory (0xF2, section 5.3)."""

    TYPE: ClassVar[int] = 0xF2
    NAME: ClassVar[str] = 'nvm_read_request'
    SERVICE: ClassVar[bool] = True

    page: int = wire(integer('B'))


@dataclass(frozen=True, slots=True)
class NvmPage(BahrsMessage):
    """One page of the non-volatile memory, 32 bytes (0xF3, section 5.4)."""

    TYPE: ClassVar[int] = 0xF3
    NAME: ClassVar[str] = 'nvm_page'
    SERVICE: ClassVar[bool] = True

    page: int = wire(integer('B'))
    data: bytes = wire(block(32))


@dataclass(frozen=True, slots=True)
class Acknowledgement(BahrsMessage):
    """The device's answer to a service message; status 0 is success (0xFF, section 5.5)."""

    TYPE: ClassVar[int] = 0xFF
    NAME: ClassVar[str] = 'acknowledgement'
    SERVICE: ClassVar[bool] = True

    acknowledged: int = wire(integer('B'))
    status: int = wire(integer('B'))


MESSAGES: tuple[type[BahrsMessage], ...] = (
    Inertial, Navigation, Accuracy, NavigationTime, InertialTime, SyncPulseTime,
    SoftwareVersion, HardwareVersion,
    EnterDiagnostics, ExitDiagnostics, NvmReadRequest, NvmPage, Acknowledgement,
)


@lru_cache(maxsize=2)
def layouts(height_format: HeightFormat = 'uint16'
            ) -> Mapping[tuple[int, int], Layout[BahrsMessage]]:
    """
    Return the layout of every message by (version, type).

    The document states int16 for the pressure height, but the device sends uint16: decoded as
    signed, heights above 4,500 m are 11,000 m too low.
    """
    replace = {'pressure_height': _HEIGHT_ROWS[height_format]}
    return {(version, message.TYPE): Layout(message, version, replace=replace)
            for version in VERSIONS for message in MESSAGES if message.SINCE <= version}
