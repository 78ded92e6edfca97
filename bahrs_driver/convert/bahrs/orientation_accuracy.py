# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What the accuracy message of the BAHRS says of the orientation that is published.

Its deviations are rotations about north, east and down. North is magnetic: the device measures
the magnetic heading, and neither its messages nor its memory hold a declination or a position to
compute one from. So about the published axes, turned by the declination, they are correlated.

Without a heading the direction of north is unknown, and the larger of the two tilts counts for
both. What the message does not say, or when there is none, has the deviation that the user
assumes.
"""

import math

from bahrs_driver.convert import covariance
from bahrs_driver.convert.axes import Convention
from bahrs_driver.convert.bahrs.integrity_policy import inflated, Worth
from bahrs_driver.convert.covariance import Matrix, UNKNOWN_VARIANCE
from bahrs_driver.protocol.bahrs.messages import Accuracy

# The accuracy message comes with every tenth navigation message; without it for this many the
# last one says nothing about the present.
LIFETIME = 100
_NONE = Accuracy(0, None, None, None, 0)


class OrientationAccuracy:
    """Keeps the latest accuracy message, and gives deviations and covariances by it."""

    def __init__(self, convention: Convention, declination: float, fallback: float) -> None:
        self._convention = convention
        self._cos, self._sin = math.cos(declination), math.sin(declination)
        self._fallback = fallback or None
        self.begin()

    def begin(self) -> None:
        """Forget what was said: another stream begins."""
        self.take(_NONE)

    def take(self, message: Accuracy) -> None:
        """Use an accuracy message from now on."""
        self._message, self._age = message, 0
        self._matrices: dict[tuple[float, Worth], Matrix] = {}

    def count_navigation(self) -> None:
        """Count a navigation message, for an accuracy message holds for LIFETIME of them."""
        self._age += 1
        if self._age > LIFETIME:
            self.begin()

    def north(self, worth: float) -> float | None:
        """Return the deviation about magnetic north, in rad, inflated by a worth."""
        return self._inflated(self._message.north_std, worth)

    def heading(self, worth: float) -> float | None:
        """Return the deviation of the heading, in rad, inflated by a worth."""
        return self._inflated(self._message.heading_std, worth)

    def matrix(self, level: float, heading: Worth) -> Matrix:
        """Return the covariance of an orientation whose roll and pitch have some worth."""
        key = level, heading
        matrix = self._matrices.get(key)
        if matrix is None:
            matrix = self._matrices[key] = self._matrix(level, heading)
        return matrix

    def _matrix(self, level: float, heading: Worth) -> Matrix:
        north, east = self.north(level), self._inflated(self._message.east_std, level)
        if heading is None:
            tilt = UNKNOWN_VARIANCE if north is None or east is None else max(north, east) ** 2
            return covariance.diagonal((tilt, tilt, UNKNOWN_VARIANCE))
        down = self.heading(heading)
        if north is east is down is None:
            return covariance.UNKNOWN
        return self._rotated(*(UNKNOWN_VARIANCE if deviation is None else deviation ** 2
                               for deviation in (north, east, down)))

    def _rotated(self, north: float, east: float, down: float) -> Matrix:
        """Return the covariance about the published axes from variances about the device's."""
        c, s = self._cos, self._sin
        x, y, z = self._convention.diagonal((
            c * c * north + s * s * east, s * s * north + c * c * east, down))
        both = s * c * (north - east)       # the same for north and east as for east and north
        return (x, both, 0.0, both, y, 0.0, 0.0, 0.0, z)

    def _inflated(self, deviation: float | None, worth: float) -> float | None:
        return inflated(self._fallback if deviation is None else deviation, worth)
