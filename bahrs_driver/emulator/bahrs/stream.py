# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The messages of a BAHRS about its samples, in the order that a recording of a real one shows.

    inertial      0    1  2       3  4              19  20
    navigation    0       1          2       ...        10       every second inertial message
    time          5 3 4                                 5 3 4    every twentieth

A navigation message and the inertial message before it belong to the same instant. Time messages
carry the time of the latest sample and, by a quirk of the real device, the counter of the next.
"""

from collections.abc import Mapping
import math
from typing import Literal

from bahrs_driver.emulator.measurement_errors import (
    clamp, clamp_vector, MeasurementErrors, Values,
)
from bahrs_driver.emulator.motion import Truth, TURN
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    ANGLE,
    BahrsMessage,
    FORCE_2,
    HEIGHT,
    HEIGHT_OFFSET,
    Inertial,
    InertialTime,
    Navigation,
    NavigationTime,
    RATE_2,
    SyncPulseTime,
    VELOCITY,
)
from bahrs_driver.protocol.integrity import Health, Integrity
from bahrs_driver.units import COUNTER_MODULUS

INERTIAL_PERIOD_US = 5000
INERTIAL_PER_NAVIGATION = 2
NAVIGATION_PER_TIME = 10
SIGNALS = Inertial.SIGNALS + Navigation.SIGNALS
UNALIGNED_MESSAGES = 8      # navigation messages without data after power-on

FORCE_LIMIT, RATE_LIMIT, VELOCITY_LIMIT = 32767 * FORCE_2, 32767 * RATE_2, 32767 * VELOCITY
_LOWEST, _HIGHEST = HEIGHT_OFFSET, HEIGHT_OFFSET + 65535 * HEIGHT
_UNAVAILABLE = (Integrity.UNAVAILABLE,) * len(Navigation.SIGNALS)

# A device sends raw zeros in place of an unavailable signal.
_NO_INERTIAL = (0.0,) * len(Inertial.SIGNALS)
_NO_NAVIGATION = (HEIGHT_OFFSET, 0.0, 0.0, 0.0, 0.0)

# rad, at power-on and after a long alignment.
_FIRST_DEVIATION = 0.091
_MIN_ATTITUDE_DEVIATION, _MIN_HEADING_DEVIATION = 0.005, 0.0175

TimeLabel = Literal['next', 'same']
TimedMessage = Accuracy | InertialTime | NavigationTime | SyncPulseTime
SimulatedMessage = tuple[BahrsMessage, Mapping[str, object]]        # with its true values


def with_own_time(message: TimedMessage) -> SimulatedMessage:
    """Return a message whose fields are the truth."""
    return message, {'device_time_us': message.device_time_us, 'sequence': message.sequence}


class BahrsStream:
    """Simulates the messages of a device since power-on, sample by sample."""

    def __init__(self, version: int, time_label: TimeLabel, errors: MeasurementErrors) -> None:
        self._version = version
        self._reference_ahead = int(time_label == 'next')
        self._errors = errors
        self._health = dict.fromkeys(SIGNALS, Integrity.SAFE)
        self._inertial_health: Health = ()
        self._navigation_health: Health = ()
        self.set_integrity(())
        self.restart()

    def restart(self) -> None:
        """Restart as after power-on. The commanded integrity remains."""
        self._count = 0

    @property
    def count(self) -> int:
        """Count of samples since power-on."""
        return self._count

    def set_integrity(self, signals: tuple[str, ...],
                      integrity: Integrity = Integrity.SAFE) -> None:
        """Set the integrity of signals from the next sample on."""
        self._health.update(dict.fromkeys(signals, integrity))
        self._inertial_health = tuple(self._health[name] for name in Inertial.SIGNALS)
        self._navigation_health = tuple(self._health[name] for name in Navigation.SIGNALS)
        self._blanks = Integrity.UNAVAILABLE in self._health.values()

    def sample(self, truth: Truth, device_time_us: int) -> list[SimulatedMessage]:
        """Return the messages about the next sample, in the order of transmission."""
        count, navigation_count = self._count, self._count // INERTIAL_PER_NAVIGATION
        self._count += 1
        with_navigation = count % INERTIAL_PER_NAVIGATION == 0
        with_time = with_navigation and navigation_count % NAVIGATION_PER_TIME == 0
        messages = [self._inertial(count, truth, device_time_us)]
        if with_time:
            messages.append(self._time(InertialTime, count, device_time_us))
        if with_navigation:
            messages.append(self._navigation(navigation_count, truth, device_time_us))
        if with_time:
            aligned = navigation_count >= UNALIGNED_MESSAGES
            messages.append(self._accuracy(navigation_count, device_time_us if aligned else 0))
            messages.append(self._time(NavigationTime, navigation_count, device_time_us)
                            if aligned else with_own_time(NavigationTime(0, 0, 0)))
        return messages

    def _inertial(self, count: int, truth: Truth, device_time_us: int) -> SimulatedMessage:
        sequence, add = count % COUNTER_MODULUS, self._errors.add_vector
        true_force, true_rate = truth.specific_force, truth.angular_rate
        force = clamp_vector(add('specific_force', true_force), FORCE_LIMIT)
        rate = clamp_vector(add('angular_rate', true_rate), RATE_LIMIT)
        if self._blanks:
            x, y, z, p, q, r = _blanked(force + rate, self._inertial_health, _NO_INERTIAL)
            force, rate = (x, y, z), (p, q, r)
        return Inertial(sequence, force, rate, self._inertial_health), {
            'device_time_us': device_time_us, 'specific_force': true_force,
            'angular_rate': true_rate, 'sequence': sequence}

    def _navigation(self, count: int, truth: Truth, device_time_us: int) -> SimulatedMessage:
        sequence = count % COUNTER_MODULUS
        aligned = count >= UNALIGNED_MESSAGES
        health = self._navigation_health if aligned else _UNAVAILABLE
        values = self._navigation_values(truth)
        if self._blanks or not aligned:
            values = _blanked(values, health, _NO_NAVIGATION)
        height, velocity, roll, pitch, heading = values
        message = Navigation(sequence, height, velocity, roll, pitch, heading, health)
        return message, {
            'device_time_us': device_time_us, 'pressure_height': truth.pressure_height,
            'velocity_down': truth.velocity_down, 'roll': truth.roll, 'pitch': truth.pitch,
            'magnetic_heading': truth.heading, 'sequence': sequence}

    def _navigation_values(self, truth: Truth) -> Values:
        errors = self._errors
        height = errors.add('pressure_height', truth.pressure_height)
        velocity = errors.add('velocity_down', truth.velocity_down)
        roll, pitch, heading = errors.add_vector(
            'attitude', (truth.roll, truth.pitch, truth.heading))
        return (max(_LOWEST, min(_HIGHEST, height)),
                clamp(velocity, VELOCITY_LIMIT),
                _half_turn(roll), _half_turn(pitch),
                _half_turn(heading) if self._version == 1 else heading % TURN)

    def _accuracy(self, navigation_count: int, device_time_us: int) -> SimulatedMessage:
        index = navigation_count // NAVIGATION_PER_TIME
        if not device_time_us:
            return with_own_time(Accuracy(index % COUNTER_MODULUS, None, None, None, 0))
        deviation = _FIRST_DEVIATION / math.sqrt(max(1, index))
        attitude = max(_MIN_ATTITUDE_DEVIATION, deviation)
        heading = max(_MIN_HEADING_DEVIATION, deviation)
        return with_own_time(Accuracy(
            index % COUNTER_MODULUS, attitude, attitude, heading, device_time_us))

    def _time(self, kind: type[InertialTime] | type[NavigationTime], count: int,
              device_time_us: int) -> SimulatedMessage:
        per_time = NAVIGATION_PER_TIME * (
            INERTIAL_PER_NAVIGATION if kind is InertialTime else 1)
        return with_own_time(kind(
            count // per_time % COUNTER_MODULUS, (count + self._reference_ahead) % COUNTER_MODULUS,
            device_time_us))


def _blanked(values: Values, health: Health, blanks: Values) -> Values:
    """Return the values, with blanks in place of unavailable signals."""
    return tuple(value if integrity else blank
                 for value, integrity, blank in zip(values, health, blanks))


def _half_turn(angle: float) -> float:
    """Return the angle between -pi and pi, limited to the range of its field."""
    return clamp(math.remainder(angle, TURN), 32767 * ANGLE)
