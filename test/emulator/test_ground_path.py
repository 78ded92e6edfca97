# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the path of a motion: velocity and position agree."""

import math

from bahrs_driver.emulator.flights import Flight, Still
from bahrs_driver.emulator.ground_path import GroundPath
from bahrs_driver.emulator.motion import SmoothValue, true_values
from pyproj import Geod
import pytest

WGS84 = Geod(ellps='WGS84')
AWAY = SmoothValue(0.0)


class Straight:
    """A constant speed and course."""

    def __init__(self, speed, course, height=0.0):
        """Set the speed in m/s, the course in degrees and the height in m."""
        self._truth = true_values(SmoothValue(speed), AWAY, SmoothValue(math.radians(course)),
                                  SmoothValue(1.0), height)

    def at(self, time):
        """Return the true values, which never change."""
        return self._truth


@pytest.mark.parametrize('start, course, speed', [
    ((0.0, 10.0), 90.0, 100.0), ((0.0, -179.9), 270.0, 300.0), ((-20.0, 5.0), 0.0, 250.0),
    ((60.0, 5.0), 180.0, 250.0)])
def test_along_the_equator_and_along_a_meridian_it_is_the_geodesic(start, course, speed):
    """The error is at most 0.1 mm after ten minutes, across the date line, too."""
    _, position, (north, east) = GroundPath(Straight(speed, course), *start).at(600.0)
    longitude, latitude, _ = WGS84.fwd(start[1], start[0], course, 600.0 * speed)
    _, _, away = WGS84.inv(longitude, latitude, position.longitude, position.latitude)
    assert away < 1e-4
    assert math.hypot(north, east) == pytest.approx(600.0 * speed, abs=1e-6)


@pytest.mark.parametrize('time', [40.0, 95.3, 400.01, 700.0])
def test_the_slope_of_the_position_is_the_velocity(time):
    """In flight, the geodesic over 20 ms fits the velocity; height makes the arc longer."""
    path = GroundPath(Flight(), 47.0, 5.9999)
    before, after = path.at(time - 0.01)[1], path.at(time + 0.01)[1]
    truth_now = path.at(time)[0]
    course, _, distance = WGS84.inv(before.longitude, before.latitude,
                                    after.longitude, after.latitude)
    north, east, _ = truth_now.velocity
    speed = distance / 0.02 * (1 + truth_now.pressure_height / 6.38e6)
    assert speed == pytest.approx(math.hypot(north, east), rel=2e-4)
    assert math.radians(course) == pytest.approx(math.atan2(east, north), abs=1e-4)
    assert (after.altitude - before.altitude) / 0.02 == pytest.approx(
        -truth_now.velocity_down, abs=1e-3)


def test_times_in_any_order():
    """The position is the same each time."""
    path = GroundPath(Flight(), 47.0, 11.0)
    late = path.at(123.456)
    early = path.at(7.0)
    assert path.at(123.456) == late and path.at(7.0) == early
    assert GroundPath(Flight(), 47.0, 11.0).at(123.456) == late


def test_at_rest_nothing_moves():
    """The position does not change."""
    _, position, moved = GroundPath(Still(), 47.0, 11.0).at(1000.0)
    assert (round(position.latitude, 12), round(position.longitude, 12), moved) == (
        47.0, 11.0, (0.0, 0.0))
