# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The path of a motion over the WGS 84 ellipsoid.

The rates of latitude and longitude follow from the velocity, the latitude and the height. The
plain integrals of the velocity are the position relative to the start, as a device counts it. A
fourth-order Runge-Kutta method with steps of 0.05 s is exact to far below a millimetre for
motions as smooth as these.
"""

import math
from typing import NamedTuple

from bahrs_driver.emulator.motion import Motion, Truth

SEMI_MAJOR = 6_378_137.0                    # m
FLATTENING = 1 / 298.257223563
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)
STEP = 0.05                                 # s

_Point = tuple[float, float, float, float]  # latitude, longitude (rad), north, east (m)


class GeodeticPosition(NamedTuple):
    """Latitude and longitude in degrees, altitude in m above the ellipsoid."""

    latitude: float
    longitude: float
    altitude: float


class GroundPath:
    """The path of a motion over the ground."""

    def __init__(self, motion: Motion, latitude: float, longitude: float) -> None:
        """Start at a latitude and longitude in degrees, at time 0."""
        self._motion = motion
        self._points: list[_Point] = [(math.radians(latitude), math.radians(longitude), 0.0, 0.0)]

    def at(self, time: float) -> tuple[Truth, GeodeticPosition, tuple[float, float]]:
        """
        Return truth, position, and distances north and east of the start (m) at a time in s.

        The pressure height of the motion serves as the altitude.
        """
        index = int(time / STEP)
        while len(self._points) <= index:
            begin = STEP * (len(self._points) - 1)
            self._points.append(self._integrate(self._points[-1], begin, STEP))
        latitude, longitude, north, east = self._integrate(
            self._points[index], STEP * index, time - STEP * index)
        truth = self._motion.at(time)
        return truth, GeodeticPosition(
            math.degrees(latitude), math.remainder(math.degrees(longitude), 360.0),
            truth.pressure_height), (north, east)

    def _integrate(self, point: _Point, time: float, span: float) -> _Point:
        """Return the point that a point reaches within a span, from a time on; in seconds."""
        middle = self._motion.at(time + span / 2)
        first = _rates(point, self._motion.at(time))
        second = _rates(_extrapolate(point, first, span / 2), middle)
        third = _rates(_extrapolate(point, second, span / 2), middle)
        fourth = _rates(_extrapolate(point, third, span), self._motion.at(time + span))
        a, b, c, d = ((p + 2 * q + 2 * r + s) / 6
                      for p, q, r, s in zip(first, second, third, fourth))
        return _extrapolate(point, (a, b, c, d), span)


def _extrapolate(point: _Point, rates: _Point, span: float) -> _Point:
    a, b, c, d = (value + rate * span for value, rate in zip(point, rates))
    return a, b, c, d


def _rates(point: _Point, truth: Truth) -> _Point:
    """Return the derivatives of a point by time."""
    sine = math.sin(point[0])
    square = 1 - ECCENTRICITY_SQUARED * sine * sine
    # Radii of curvature, along the parallel and along the meridian.
    east_radius = SEMI_MAJOR / math.sqrt(square)
    north_radius = east_radius * (1 - ECCENTRICITY_SQUARED) / square
    north, east, _ = truth.velocity
    height = truth.pressure_height
    return (north / (north_radius + height), east / ((east_radius + height) * math.cos(point[0])),
            north, east)
