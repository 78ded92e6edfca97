# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of UTM, compared with another implementation of transverse Mercator."""

import math

from bahrs_driver.convert.utm import to_wgs84, ZONES
from hypothesis import given, strategies as st
import pytest

A, F = 6_378_137.0, 1 / 298.257223563
N = F / (2 - F)
RADIUS = A / (1 + N) * (1 + N ** 2 / 4 + N ** 4 / 64)
ALPHA = (N / 2 - 2 / 3 * N ** 2 + 5 / 16 * N ** 3, 13 / 48 * N ** 2 - 3 / 5 * N ** 3,
         61 / 240 * N ** 3)


def utm(latitude, longitude, zone, northern):
    """Return easting and northing by Krueger's series of third order, exact to a millimetre."""
    phi, lam = math.radians(latitude), math.radians(longitude - (6 * zone - 183))
    root = 2 * math.sqrt(N) / (1 + N)
    t = math.sinh(math.atanh(math.sin(phi)) - root * math.atanh(root * math.sin(phi)))
    xi, eta = math.atan2(t, math.cos(lam)), math.atanh(math.sin(lam) / math.hypot(1, t))
    x = eta + sum(alpha * math.cos(2 * j * xi) * math.sinh(2 * j * eta)
                  for j, alpha in enumerate(ALPHA, 1))
    y = xi + sum(alpha * math.sin(2 * j * xi) * math.cosh(2 * j * eta)
                 for j, alpha in enumerate(ALPHA, 1))
    return 500_000 + 0.9996 * RADIUS * x, (0 if northern else 1e7) + 0.9996 * RADIUS * y


def metres(place, latitude, longitude):
    """Return the distance between two places."""
    return math.hypot(math.radians(place.latitude - latitude) * A,
                      math.radians(math.remainder(place.longitude - longitude, 360))
                      * A * math.cos(math.radians(latitude)))


@given(st.sampled_from(ZONES), st.floats(-3.5, 3.5), st.floats(-80, 84))
def test_every_zone_and_both_hemispheres(zone, off, latitude):
    """The error is below a millimetre, even a little outside of the zone."""
    longitude = 6 * zone - 183 + off
    place = to_wgs84(*utm(latitude, longitude, zone, latitude >= 0), zone, latitude >= 0)
    assert metres(place, latitude, longitude) < 0.002


def test_a_known_place():
    """The CN Tower is at 17T 630084 4833438."""
    place = to_wgs84(630_084.0, 4_833_438.0, 17, True)
    assert metres(place, 43.642566, -79.387139) < 2.0


@pytest.mark.parametrize('zone', [0, 61, 99, 255])
def test_an_invalid_zone_has_no_position(zone):
    """Zones are numbered from 1 to 60."""
    assert to_wgs84(500_000.0, 5e6, zone, True) is None


@pytest.mark.parametrize('easting, northing', [(0.0, 0.0), (-1.0, 5e6), (2e6, 5e6), (5e5, 2e7)])
def test_invalid_coordinates_have_no_position(easting, northing):
    """Zeros are invalid, too: they are outside of all zones."""
    assert to_wgs84(easting, northing, 32, True) is None


def test_coordinates_across_the_equator():
    """A northing may be below zero, or above ten million."""
    north = to_wgs84(500_000.0, -100.0, 31, True)
    south = to_wgs84(500_000.0, 1e7 - 100.0, 31, False)
    assert metres(north, south.latitude, south.longitude) < 1e-6 and north.latitude < 0
