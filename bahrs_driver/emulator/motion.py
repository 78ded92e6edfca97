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
from collections.abc import Iterable
from itertools import accumulate
import math
from typing import NamedTuple, Protocol

from bahrs_driver.protocol.layout import Vector
from bahrs_driver.units import STANDARD_GRAVITY

TURN = 2 * math.pi


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


class Profile:
    """
    A quantity that changes smoothly from value to value.

    Each step is a quintic, the least polynomial whose first and second derivatives vanish at both
    ends. The integral is exact.
    """

    def __init__(self, start: float, steps: Iterable[tuple[float, float]]) -> None:
        """Start at a value; each step has a duration in seconds and the value at its end."""
        durations, values = zip(*steps)
        self._starts: list[float] = [0.0, *accumulate(durations)]
        self._durations: tuple[float, ...] = durations
        self._values: list[float] = [start, *values]
        areas = ((a + b) / 2 * duration
                 for a, b, duration in zip(self._values, self._values[1:], durations))
        self._integrals: list[float] = [0.0, *accumulate(areas)]

    @property
    def duration(self) -> float:
        """Seconds from the start to the end of the last step."""
        return self._starts[-1]

    def at(self, time: float) -> SmoothValue:
        """Return the quantity at a time from 0 to the duration."""
        _, x, duration, start, rise = self._step(time)
        if not rise:
            return SmoothValue(start)
        y = 1 - x
        return SmoothValue(start + rise * x ** 3 * (10 - 15 * x + 6 * x * x),
                           rise * 30 * x * x * y * y / duration,
                           rise * 60 * x * y * (y - x) / (duration * duration))

    def integral(self, time: float) -> float:
        """Return the integral of the quantity from 0 to a time."""
        index, x, duration, start, rise = self._step(time)
        return (self._integrals[index]
                + duration * (start * x + rise * x ** 4 * (2.5 - 3 * x + x * x)))

    def _step(self, time: float) -> tuple[int, float, float, float, float]:
        index = min(bisect_right(self._starts, time), len(self._durations)) - 1
        start, duration = self._values[index], self._durations[index]
        return (index, (time - self._starts[index]) / duration, duration, start,
                self._values[index + 1] - start)


def true_values(speed: SmoothValue, climb: SmoothValue, track: SmoothValue,
                airborne: SmoothValue, height: float) -> Truth:
    """
    Return the true values that follow from ground speed, climb rate and track.

    airborne is the share of the bank of a coordinated turn: 0 on the ground, 1 in the air.
    """
    bank = _coordinated_bank(speed, track)
    roll = airborne.value * bank.value
    roll_rate = airborne.first * bank.value + airborne.value * bank.first
    pitch, pitch_rate = _path_pitch(speed, climb)
    sin_track, cos_track = math.sin(track.value), math.cos(track.value)
    axes = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
    # Level axes: forward along the track, right, down.
    force = _to_body(
        (speed.first, speed.value * track.first, -climb.first - STANDARD_GRAVITY), axes)
    p, q, r = _to_body((0.0, 0.0, track.first), axes)
    rate = (p + roll_rate, q + axes[1] * pitch_rate, r - axes[0] * pitch_rate)
    return Truth(
        force, rate, roll, pitch, track.value % TURN, height,
        (speed.value * cos_track, speed.value * sin_track, -climb.value))


def _coordinated_bank(speed: SmoothValue, track: SmoothValue) -> SmoothValue:
    """Return the bank of a coordinated turn, with its rate."""
    ratio = speed.value * track.first / STANDARD_GRAVITY
    ratio_rate = (speed.first * track.first + speed.value * track.second) / STANDARD_GRAVITY
    return SmoothValue(math.atan(ratio), ratio_rate / (1 + ratio * ratio))


def _path_pitch(speed: SmoothValue, climb: SmoothValue) -> tuple[float, float]:
    """Return the pitch along the path, and its rate."""
    if climb.value == climb.first == 0:
        return 0.0, 0.0
    square = speed.value ** 2 + climb.value ** 2
    return (math.atan2(climb.value, speed.value),
            (climb.first * speed.value - climb.value * speed.first) / square)


def _to_body(level: Vector, axes: tuple[float, float, float, float]) -> Vector:
    """Rotate a vector from level axes by pitch and then by roll."""
    forward, right, down = level
    sin_roll, cos_roll, sin_pitch, cos_pitch = axes
    below = sin_pitch * forward + cos_pitch * down
    return (cos_pitch * forward - sin_pitch * down,
            cos_roll * right + sin_roll * below,
            cos_roll * below - sin_roll * right)
