# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute the covariance of the published orientation from the accuracy message of the BAHRS.

Its standard deviations are of rotations about north, east and down. North is magnetic: the device
measures the magnetic heading, and neither its messages nor its memory contain a declination or a
position to compute one from. So the errors about the published axes, rotated by the declination,
are correlated.

Without a heading the direction of north is unknown, and the larger of the two tilts counts for
both. Missing values have the standard deviation that the user assumes.
"""

import math

from bahrs_driver.convert import covariance
from bahrs_driver.convert.axes import Convention
from bahrs_driver.convert.bahrs.integrity_policy import inflated_stddev, VarianceFactor
from bahrs_driver.convert.covariance import Matrix, UNKNOWN_VARIANCE
from bahrs_driver.protocol.bahrs.messages import Accuracy

# The device sends an accuracy message with every tenth navigation message; after this many without
# one, the last is out of date.
LIFETIME = 100
_NONE = Accuracy(0, None, None, None, 0)


class OrientationAccuracy:
    """Stores the latest accuracy message; fallback (rad, 0 is unknown) replaces missing values."""

    def __init__(self, convention: Convention, declination: float, fallback: float) -> None:
        self._convention = convention
        self._cos, self._sin = math.cos(declination), math.sin(declination)
        self._fallback = fallback or None
        self.reset()

    def reset(self) -> None:
        """Forget the message: another stream begins."""
        self.update(_NONE)

    def update(self, message: Accuracy) -> None:
        """Use an accuracy message from now on."""
        self._message, self._age = message, 0
        self._matrices: dict[tuple[float, VarianceFactor], Matrix] = {}

    def count_navigation(self) -> None:
        """Count a navigation message; an accuracy message is valid for LIFETIME of them."""
        self._age += 1
        if self._age > LIFETIME:
            self.reset()

    def north(self, factor: float) -> float | None:
        """Return the inflated standard deviation about magnetic north, in rad."""
        return self._inflated(self._message.north_std, factor)

    def heading(self, factor: float) -> float | None:
        """Return the inflated standard deviation of the heading, in rad."""
        return self._inflated(self._message.heading_std, factor)

    def matrix(self, tilt_factor: float, heading_factor: VarianceFactor) -> Matrix:
        """Return the covariance of the orientation, inflated by the variance factors."""
        key = tilt_factor, heading_factor
        matrix = self._matrices.get(key)
        if matrix is None:
            matrix = self._matrices[key] = self._matrix(tilt_factor, heading_factor)
        return matrix

    def _matrix(self, tilt_factor: float, heading_factor: VarianceFactor) -> Matrix:
        north = self.north(tilt_factor)
        east = self._inflated(self._message.east_std, tilt_factor)
        if heading_factor is None:
            larger = UNKNOWN_VARIANCE if north is None or east is None else max(north, east) ** 2
            return covariance.diagonal((larger, larger, UNKNOWN_VARIANCE))
        down = self.heading(heading_factor)
        if north is east is down is None:
            return covariance.UNKNOWN
        return self._rotated(*(UNKNOWN_VARIANCE if deviation is None else deviation ** 2
                               for deviation in (north, east, down)))

    def _rotated(self, north: float, east: float, down: float) -> Matrix:
        """Return the covariance about the published axes from variances about the device's."""
        c, s = self._cos, self._sin
        x, y, z = self._convention.diagonal((
            c * c * north + s * s * east, s * s * north + c * c * east, down))
        cross = s * c * (north - east)
        return (x, cross, 0.0, cross, y, 0.0, 0.0, 0.0, z)

    def _inflated(self, stddev: float | None, factor: float) -> float | None:
        return inflated_stddev(self._fallback if stddev is None else stddev, factor)
