# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The motion of a vehicle, and the true values of all measured quantities.

A motion defines ground speed, climb rate, track and the share of the bank that is flown, each with
its derivatives in closed form. Everything else follows from these four: the nose points along the
velocity, the bank is that of a coordinated turn, the angular rate is that of the Euler angles,
and the specific force is the acceleration minus gravity in body axes. Therefore the integral of
the rates is the attitude, and the forces fit the path, to the last digit and at any time.

Axes are forward, right, down and north, east, down. The earth is flat and does not turn, the
atmosphere is the standard one, and magnetic north is true north.
"""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import accumulate
import math
from typing import NamedTuple, Protocol

from bahrs_driver.protocol.layout import Vector
from bahrs_driver.units import STANDARD_GRAVITY

TURN = 2 * math.pi
_new = tuple.__new__        # takes half of the time of Truth() and SmoothValue()


class Truth(NamedTuple):
    """True values at one instant: SI, radians, heading from 0 to 2 pi."""

    specific_force: Vector          # body axes
    angular_rate: Vector            # body axes
    roll: float
    pitch: float
    heading: float
    pressure_height: float
    velocity: Vector                # north, east, down

    @property
    def velocity_down(self) -> float:
        """Vertical component of the velocity, positive downward."""
        return self.velocity[2]


class Motion(Protocol):
    """A path through the air."""

    def at(self, time: float) -> Truth:
        """Return the true values at a time in seconds since the start, at least 0."""


class SmoothValue(NamedTuple):
    """A quantity at an instant, and its first and second derivative by time."""

    value: float
    first: float = 0.0
    second: float = 0.0


class Steps:
    """The steps of quantities that change together, in `duration` seconds."""

    def __init__(self, durations: Iterable[float]) -> None:
        """Set the duration of each step in seconds."""
        self.durations = tuple(durations)
        *self._starts, self.duration = accumulate(self.durations, initial=0.0)

    def find(self, time: float) -> tuple[int, float]:
        """Return the step at a time from 0 to the duration, and the share of it that is over."""
        index = bisect_right(self._starts, time) - 1
        return index, (time - self._starts[index]) / self.durations[index]


class Profile:
    """
    A quantity that changes smoothly from value to value.

    Each step is a quintic, the least polynomial whose first and second derivatives vanish at both
    ends. The integral is exact.
    """

    def __init__(self, steps: Steps, start: float, ends: Sequence[float]) -> None:
        """Set the values at the start and at the end of each step."""
        values = [start, *ends]
        self._steps = list(zip(steps.durations, values, ends, map(SmoothValue, values)))
        areas = ((a + b) / 2 * duration for duration, a, b, _ in self._steps)
        self._integrals: list[float] = [0.0, *accumulate(areas)]

    def at(self, index: int, x: float) -> SmoothValue:
        """Return the quantity when a share of a step is over."""
        duration, start, end, constant = self._steps[index]
        if start == end:
            return constant
        rise, y = end - start, 1 - x
        return _new(SmoothValue, (
            start + rise * x ** 3 * (10 - 15 * x + 6 * x * x),
            rise * 30 * x * x * y * y / duration,
            rise * 60 * x * y * (y - x) / (duration * duration)))

    def integral(self, index: int, x: float) -> float:
        """Return the integral of the quantity since the start."""
        duration, start, end, _ = self._steps[index]
        area = start * x
        if start != end:
            area += (end - start) * x ** 4 * (2.5 - 3 * x + x * x)
        return self._integrals[index] + duration * area


def true_values(speed: SmoothValue, climb: SmoothValue, track: SmoothValue,
                airborne: SmoothValue, height: float) -> Truth:
    """
    Return the true values that follow from ground speed, climb rate and track.

    airborne is the share of the bank of a coordinated turn: 0 on the ground, 1 in the air.
    """
    ground_speed, acceleration, _ = speed
    climb_rate, climb_acceleration, _ = climb
    direction, turn_rate, turn_acceleration = track
    share, share_rate, _ = airborne
    ratio = ground_speed * turn_rate / STANDARD_GRAVITY
    ratio_rate = (acceleration * turn_rate + ground_speed * turn_acceleration) / STANDARD_GRAVITY
    bank, bank_rate = math.atan(ratio), ratio_rate / (1 + ratio * ratio)
    roll = share * bank
    roll_rate = share_rate * bank + share * bank_rate
    pitch, pitch_rate = _path_pitch(speed, climb)
    sin_roll, cos_roll = math.sin(roll), math.cos(roll)
    sin_pitch, cos_pitch = math.sin(pitch), math.cos(pitch)
    # From axes forward along the track, right and down: rotated by pitch and then by roll.
    right, down = ground_speed * turn_rate, -climb_acceleration - STANDARD_GRAVITY
    below = sin_pitch * acceleration + cos_pitch * down
    force = (cos_pitch * acceleration - sin_pitch * down,
             cos_roll * right + sin_roll * below, cos_roll * below - sin_roll * right)
    yaw_rate = 0.0 + cos_pitch * turn_rate
    return _new(Truth, (
        force, (0.0 - sin_pitch * turn_rate + roll_rate,
                sin_roll * yaw_rate + cos_roll * pitch_rate,
                cos_roll * yaw_rate - sin_roll * pitch_rate),
        roll, pitch, direction % TURN, height,
        (ground_speed * math.cos(direction), ground_speed * math.sin(direction), -climb_rate)))


def _path_pitch(speed: SmoothValue, climb: SmoothValue) -> tuple[float, float]:
    """Return the pitch along the path, and its rate."""
    ground_speed, acceleration, _ = speed
    climb_rate, climb_acceleration, _ = climb
    if climb_rate == climb_acceleration == 0:
        return 0.0, 0.0
    square = ground_speed ** 2 + climb_rate ** 2
    return (math.atan2(climb_rate, ground_speed),
            (climb_acceleration * ground_speed - climb_rate * acceleration) / square)
