# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Convert between UTM and WGS 84, for all zones and both hemispheres.

The zone need not contain the position: a device may keep its zone in flight, or use other rules at
the borders. A position a little outside of its zone is as exact as one inside.

pyproj takes a fifth of the driver's start, so only those who convert positions import it.
"""

from functools import lru_cache
from typing import NamedTuple, TYPE_CHECKING

if TYPE_CHECKING:
    from pyproj import Proj

ZONES = range(1, 61)
EASTINGS = (0.0, 1e6)               # m; zones are at most 668 km wide, about 500,000
NORTHINGS = (-1e6, 1.1e7)           # m; 0 to 1e7, and a little across the equator


class LatLon(NamedTuple):
    """A horizontal position in degrees, north and east positive."""

    latitude: float
    longitude: float


def load_pyproj() -> None:
    """Import pyproj now, so that the first position is not late."""
    _projection(ZONES[0], True)


def to_wgs84(easting: float, northing: float, zone: int, northern: bool) -> LatLon | None:
    """Convert UTM coordinates in m; None if they are outside of UTM."""
    if zone not in ZONES or not EASTINGS[0] < easting < EASTINGS[1] \
            or not NORTHINGS[0] <= northing <= NORTHINGS[1]:
        return None
    longitude, latitude = _projection(zone, northern)(easting, northing, inverse=True)
    return LatLon(latitude, longitude)


def from_wgs84(latitude: float, longitude: float, zone: int,
               northern: bool) -> tuple[float, float]:
    """Return easting and northing (m) of a position in degrees, in any zone."""
    easting, northing = _projection(zone, northern)(longitude, latitude)
    return easting, northing


@lru_cache(maxsize=2 * len(ZONES))
def _projection(zone: int, northern: bool) -> 'Proj':
    from pyproj import Proj
    return Proj(proj='utm', zone=zone, ellps='WGS84', south=not northern)
