# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The motions that `bahrs emulate --motion` offers."""

from collections.abc import Callable, Sequence
from itertools import accumulate
import math
from typing import NamedTuple

from bahrs_driver.emulator.motion import (
    Motion, Profile, SmoothValue, Steps, true_values, Truth,
)

AIRFIELD = 504.0        # m, pressure height
RUNWAY = 300.0          # degrees, heading at rest
_ZERO = SmoothValue(0.0)
_AIRBORNE = SmoothValue(1.0)


class Still:
    """At rest and level."""

    def __init__(self, height: float = AIRFIELD, heading: float = RUNWAY) -> None:
        """Stand at a height in m with a heading in degrees."""
        track = SmoothValue(math.radians(heading))
        self._truth = true_values(_ZERO, _ZERO, track, _ZERO, height)

    def at(self, _time: float) -> Truth:
        """Return the true values, which never change."""
        return self._truth


class SteadyTurn:
    """A level circle in the air, once a minute."""

    SPEED = 60.0                        # m/s
    TURN_RATE = math.radians(6.0)       # rad/s
    HEIGHT = 5000.0                     # m

    def at(self, time: float) -> Truth:
        """Return the true values at a time in seconds."""
        track = SmoothValue(self.TURN_RATE * time, self.TURN_RATE)
        return true_values(SmoothValue(self.SPEED), _ZERO, track, _AIRBORNE, self.HEIGHT)


class Phase(NamedTuple):
    """A part of a flight, described by the values at its end."""

    duration: float         # s
    speed: float            # m/s over ground
    climb: float            # m/s
    turn: float             # degrees, by the end of the phase, positive to the right
    airborne: float = 1.0   # 0 on the ground, 1 in the air


FLIGHT = (
    Phase(3, 0, 0, 0, 0),           # at rest, heading 300
    Phase(10, 8, 0, 40, 0),         # taxi
    Phase(12, 8, 0, 60, 0),         # through north
    Phase(15, 45, 0, 0, 0),         # take-off run on 040
    Phase(8, 50, 6, 0),
    Phase(8, 55, 12, 0),
    Phase(40, 60, 12, 180),         # right, through east and south to 220
    Phase(15, 60, 12, 0),
    Phase(60, 65, 12, -270),        # left, through south and north to 310
    Phase(89, 65, 12, 0),
    Phase(80, 70, 12, 360),
    Phase(80, 70, 12, 0),
    Phase(80, 70, 12, -360),
    Phase(12, 80, 0, 0),            # level off at 6,000 m
    Phase(100, 80, 0, 360),
    Phase(20, 80, 0, 0),
    Phase(100, 80, 0, -360),
    Phase(12, 80, -12, 0),          # descend
    Phase(60, 75, -12, 0),
    Phase(60, 70, -12, 180),
    Phase(96, 70, -12, 0),
    Phase(100, 65, -12, -360),
    Phase(120, 60, -12, 0),
    Phase(12, 50, -4, 0),           # approach
    Phase(20, 45, -4, 0),
    Phase(8, 40, 0, 0),             # flare
    Phase(20, 5, 0, 0, 0),          # landing run
    Phase(40, 5, 0, 170, 0),        # taxi back
    Phase(8, 0, 0, 0, 0),
)


class Flight:
    """
    Rest, taxi, climb, turns both ways, descent, landing, again and again.

    The phases must end as they begin: at rest, at the same height and heading.
    """

    def __init__(self, phases: Sequence[Phase] = FLIGHT, height: float = AIRFIELD,
                 heading: float = RUNWAY) -> None:
        """Start at a height in m and a heading in degrees."""
        self._height = height
        self._steps = Steps(phase.duration for phase in phases)
        self._speed = Profile(self._steps, 0, [phase.speed for phase in phases])
        self._climb = Profile(self._steps, 0, [phase.climb for phase in phases])
        self._airborne = Profile(self._steps, 0, [phase.airborne for phase in phases])
        headings = accumulate((phase.turn for phase in phases), initial=heading)
        start, *ends = map(math.radians, headings)
        self._track = Profile(self._steps, start, ends)

    @property
    def duration(self) -> float:
        """Seconds of one flight, from rest to rest."""
        return self._steps.duration

    def at(self, time: float) -> Truth:
        """Return the true values at a time in seconds."""
        step, share = self._steps.find(time % self._steps.duration)
        climb = self._climb
        return true_values(self._speed.at(step, share), climb.at(step, share),
                           self._track.at(step, share), self._airborne.at(step, share),
                           self._height + climb.integral(step, share))


MOTIONS: dict[str, Callable[[], Motion]] = {
    'flight': Flight, 'still': Still, 'steady-turn': SteadyTurn}
