# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The first pass over a recording: a live estimate that also collects the smoother's input."""

import math
from typing import NamedTuple

from bahrs_driver.clock.estimation.smoothed_estimate import SmoothedEstimate
from bahrs_driver.clock.estimation.smoother import Bucket, smooth
from bahrs_driver.clock.estimation.tracker import Tracker
from bahrs_driver.units import NS_PER_S

BUCKET_LENGTH = NS_PER_S // 2


class _Sample(NamedTuple):
    """A sample of a bucket; samples compare by their residual, in ns."""

    residual: int
    device: int
    offset: int


class SmootherInput(Tracker):
    """A tracker that also keeps the two smallest samples of each half second."""

    def __init__(self) -> None:
        super().__init__()
        self._epochs: list[list[Bucket]] = []
        self._index = -1
        self._begin_of_bucket, self._slope = 0, 0.0
        self._smallest: list[_Sample] = []

    def restart(self) -> None:
        """Begin another epoch: the device's clock was set to another time."""
        super().restart()
        self._close()
        self._index = -1
        self._epochs.append([])

    def feed(self, device: int, bound: int) -> None:
        """Add a sample: its device time, and the latest host time at which it was sent."""
        super().feed(device, bound)
        if device // BUCKET_LENGTH != self._index:
            self._close()
            self._index = device // BUCKET_LENGTH
            self._begin_of_bucket, self._slope = device, self.skew
        # Not relative to the estimate, which may move within the bucket.
        offset = bound - device
        residual = offset - round(self._slope * (device - self._begin_of_bucket))
        self._smallest = sorted([*self._smallest, _Sample(residual, device, offset)])[:2]

    def smoothed(self) -> SmoothedEstimate:
        """Return the estimate by all samples of the recording."""
        self._close()
        self._index = -1
        return SmoothedEstimate(smooth(buckets) for buckets in self._epochs if buckets)

    def _close(self) -> None:
        if self._smallest and self._epochs:
            first, *second = self._smallest
            gap = second[0].residual - first.residual if second else math.inf
            self._epochs[-1].append(Bucket(first.device, first.offset, gap))
        self._smallest = []
