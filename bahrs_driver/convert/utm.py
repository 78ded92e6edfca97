# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
UTM to WGS 84, for all zones and both hemispheres.

A zone is taken at its word: a position a little outside of it, as a device has it that does not
change zones in flight or goes by other rules at the borders, is as exact as one inside.
"""

from functools import lru_cache
from typing import NamedTuple

from pyproj import Proj

ZONES = range(1, 61)
EASTINGS = (0.0, 1e6)               # m; zones are at most 668 km wide, about 500,000
NORTHINGS = (-1e6, 1.1e7)           # m; 0 to 1e7, and a little across the equator


class Place(NamedTuple):
    """A horizontal position in degrees, north and east positive."""

    latitude: float
    longitude: float


def to_wgs84(easting: float, northing: float, zone: int, northern: bool) -> Place | None:
    """Return the place of UTM coordinates in m; None if they are none of UTM."""
    if zone not in ZONES or not EASTINGS[0] < easting < EASTINGS[1] \
            or not NORTHINGS[0] <= northing <= NORTHINGS[1]:
        return None
    longitude, latitude = _projection(zone, northern)(easting, northing, inverse=True)
    return Place(latitude, longitude)


@lru_cache(maxsize=2 * len(ZONES))
def _projection(zone: int, northern: bool) -> Proj:
    return Proj(proj='utm', zone=zone, ellps='WGS84', south=not northern)
