# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The estimate of a second pass over a recording: known before the first sample."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from bahrs_driver.units import NS_PER_S

NEAR_BEGIN = NS_PER_S // 2


class Knot(NamedTuple):
    """Offset in ns and skew at a device time in ns."""

    time: int
    offset: int
    skew: float


class OffsetCurve:
    """Host time minus device time in an epoch, piecewise linear between knots."""

    def __init__(self, begin: int, knots: Sequence[Knot]) -> None:
        """Use knots in ascending order; begin is the device time of the first sample."""
        self._begin = begin
        self._knots = knots
        self._times = [knot.time for knot in knots]

    def offset(self, device: int) -> int:
        """Return the offset at a device time."""
        index = bisect_right(self._times, device)
        if 0 < index < len(self._knots):
            before, after = self._knots[index - 1:index + 1]
            return before.offset + (after.offset - before.offset) * (device - before.time) \
                // (after.time - before.time)
        end = self._knots[max(0, index - 1)]
        return end.offset + round(end.skew * (device - end.time))

    def skew(self, device: int) -> float:
        """Return the skew at a device time."""
        return self._knots[max(0, bisect_right(self._times, device) - 1)].skew

    def begins_near(self, device: int) -> bool:
        """Whether the first sample had about this device time."""
        return abs(device - self._begin) <= NEAR_BEGIN


class SmoothedEstimate:
    """Follows the offset curve of the present epoch; implements `Estimate`."""

    rough = False
    skew_deviation = 100e-6
    spread = 0.0
    rejected = 0

    def __init__(self, curves: Iterable[OffsetCurve]) -> None:
        """Use a curve for each epoch of the device's clock."""
        self._curves = list(curves)
        self._curve: OffsetCurve | None = None
        self._device = 0

    @property
    def started(self) -> bool:
        """Whether the epoch is known."""
        return self._curve is not None

    ready = started

    @property
    def skew(self) -> float:
        """How much faster host time runs than device time, in ns per ns."""
        return self._curve.skew(self._device) if self._curve else 0.0

    def restart(self) -> None:
        """Begin another epoch; its first sample selects the curve."""
        self._curve = None

    def feed(self, device: int, bound: int) -> None:
        """Select the curve of the epoch by its first sample; ignore all others."""
        if self._curve is None and self._curves:
            # The curve of a few late samples may extend anywhere, and be near by chance.
            self._curve = min(self._curves, key=lambda curve: (
                not curve.begins_near(device), abs(bound - device - curve.offset(device))))

    def host_time(self, device: int) -> int:
        """Return the host time of a device time. The epoch must be known."""
        assert self._curve
        self._device = device
        return device + self._curve.offset(device)
