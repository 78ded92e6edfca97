# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The messages of the Titan-M, one row for each field: three requests and their answers.

Vectors are in the axes of the device: body axes forward, right, down; navigation axes north, east,
down. Values are SI unless their name has another unit. The document does not state the byte order
of payloads, so each answer has a layout for both.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal

from bahrs_driver.protocol.layout import (
    before_reserved,
    flag,
    integer,
    Layout,
    reals,
    scaled,
    Vector,
    vector,
    wire,
)
from bahrs_driver.protocol.message import Message
from bahrs_driver.units import STANDARD_GRAVITY

ADC_FORCE = 2.522e-3 * STANDARD_GRAVITY  # m/s^2
ADC_RATE_DEG = 0.07326                  # degree/s
TEMPERATURE_C = 1 / 128                 # degree C
PRESSURE = 5e-3                         # Pa
DIFFERENTIAL_PRESSURE = 0.25e-6         # Pa
FIELD = 70e-6 * 1e-4                    # T, 70 microgauss
CENTIMETRE = 0.01                       # m
HEADING_DEG = 1e-5                      # degree
LAST_ZONE = 60                          # of UTM; the first is 1

ByteOrder = Literal['little', 'big']
STRUCT_ORDERS: dict[ByteOrder, str] = {'little': '<', 'big': '>'}


class TitanMessage(Message):
    """A message of a Titan-M."""

    __slots__ = ()


class TitanAnswer(TitanMessage):
    """An answer, and its possible values of LEN, the size of payload and checksum."""

    __slots__ = ()
    LENGTHS: ClassVar[tuple[int, ...]]


@dataclass(frozen=True, slots=True)
class State(TitanAnswer):
    """
    Solution of the navigation filter (state information, 48 bytes).

    Position (m) is relative to the first GPS fix, velocity is in m/s, both in navigation axes;
    attitude is roll, pitch, heading (rad); the rate is about the body axes (rad/s).
    """

    NAME: ClassVar[str] = 'state'
    LENGTHS: ClassVar[tuple[int, ...]] = (0x32,)

    position_ned: Vector = wire(reals('f', 3, 'm'))
    velocity_ned: Vector = wire(reals('f', 3, 'm/s'))
    attitude: Vector = wire(reals('f', 3, 'rad'))
    angular_rate: Vector = wire(reals('f', 3, 'rad/s'))


@dataclass(frozen=True, slots=True)
class Gps(TitanAnswer):
    """
    Solution of the GPS receiver (GPS position, 44 bytes).

    Time is GPS time of week; easting and northing are UTM. A zone outside 1 to 60 means no
    position.
    """

    NAME: ClassVar[str] = 'gps'
    LENGTHS: ClassVar[tuple[int, ...]] = (0x2E,)

    gps_time_s: float = wire(scaled('I', 1e-3, 's'))
    easting: float = wire(scaled('i', CENTIMETRE, 'm'))
    northing: float = wire(scaled('i', CENTIMETRE, 'm'))
    altitude: float = wire(scaled('i', CENTIMETRE, 'm'))
    velocity_ned: Vector = wire(vector('i', CENTIMETRE, 'm/s'))
    heading_deg: float = wire(scaled('i', HEADING_DEG, 'degree'))
    speed: float = wire(scaled('I', CENTIMETRE, 'm/s'))
    ground_speed: float = wire(scaled('I', CENTIMETRE, 'm/s'))
    zone: int = wire(integer('B'))
    northern: bool = wire(before_reserved(2, flag(0)))


@dataclass(frozen=True, slots=True)
class Sensors(TitanAnswer):
    """
    Measurements of the sensors (sensor data, 56 bytes), as ADC counts and calibrated.

    Specific force (m/s^2), angular rate (rad/s) and magnetic field are in body axes. The document
    states LEN as 0x2E, that of the GPS answer, but 56 bytes require 0x3A.
    """

    NAME: ClassVar[str] = 'sensors'
    LENGTHS: ClassVar[tuple[int, ...]] = (0x3A, 0x2E)

    adc_acceleration: Vector = wire(vector('h', ADC_FORCE, 'm/s^2'))
    adc_angular_rate_deg: Vector = wire(
        before_reserved(2, vector('h', ADC_RATE_DEG, 'degree/s')))
    temperature_c: float = wire(scaled('h', TEMPERATURE_C, 'degree C'))
    acceleration: Vector = wire(reals('f', 3, 'm/s^2'))
    angular_rate: Vector = wire(reals('f', 3, 'rad/s'))
    absolute_pressure: float = wire(scaled('I', PRESSURE, 'Pa'))
    differential_pressure: float = wire(scaled('I', DIFFERENTIAL_PRESSURE, 'Pa'))
    magnetic_field_tesla: Vector = wire(before_reserved(2, vector('h', FIELD, 'T')))


class TitanRequest(TitanMessage):
    """A request: its command on the wire, and the kind of its answer."""

    __slots__ = ()
    COMMAND: ClassVar[bytes]
    ANSWER: ClassVar[type[TitanAnswer]]


@dataclass(frozen=True, slots=True)
class StateRequest(TitanRequest):
    """Host to device: send the state."""

    NAME: ClassVar[str] = 'state_request'
    COMMAND: ClassVar[bytes] = b'GST'
    ANSWER: ClassVar[type[TitanAnswer]] = State


@dataclass(frozen=True, slots=True)
class GpsRequest(TitanRequest):
    """Host to device: send the GPS position."""

    NAME: ClassVar[str] = 'gps_request'
    COMMAND: ClassVar[bytes] = b'GGP'
    ANSWER: ClassVar[type[TitanAnswer]] = Gps


@dataclass(frozen=True, slots=True)
class SensorsRequest(TitanRequest):
    """Host to device: send the measurements of the sensors."""

    NAME: ClassVar[str] = 'sensors_request'
    COMMAND: ClassVar[bytes] = b'GSE'
    ANSWER: ClassVar[type[TitanAnswer]] = Sensors


ANSWERS: tuple[type[TitanAnswer], ...] = (State, Gps, Sensors)
REQUESTS: tuple[type[TitanRequest], ...] = (StateRequest, GpsRequest, SensorsRequest)

LAYOUTS: dict[tuple[type[TitanAnswer], ByteOrder], Layout[TitanAnswer]] = {
    (kind, order): Layout(kind, byte_order=code)
    for kind in ANSWERS for order, code in STRUCT_ORDERS.items()}
PAYLOAD_SIZES = {kind: LAYOUTS[kind, 'little'].size for kind in ANSWERS}
assert list(PAYLOAD_SIZES.values()) == [48, 44, 56]
