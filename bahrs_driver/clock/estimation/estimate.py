# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of an estimate of host time for device time."""

from typing import Protocol


class Estimate(Protocol):
    """Host time for device time, from samples as they arrive. Times in ns."""

    @property
    def started(self) -> bool:
        """Whether there is an estimate."""

    @property
    def ready(self) -> bool:
        """Whether enough samples support the estimate to stamp by it."""

    @property
    def rough(self) -> bool:
        """Whether the estimate may still be late by the longest delay of an adapter."""

    @property
    def skew(self) -> float:
        """How much faster host time runs than device time, in ns per ns."""

    @property
    def skew_deviation(self) -> float:
        """Return the standard deviation of the skew."""

    @property
    def spread(self) -> float:
        """Usual gap between the smallest delays, in ns."""

    @property
    def rejected(self) -> int:
        """Count of rejected measurements."""

    def restart(self) -> None:
        """Begin another epoch: the device's clock was set to another time."""

    def feed(self, device: int, bound: int) -> None:
        """Add a sample: its device time, and the latest host time at which it was sent."""

    def host_time(self, device: int) -> int:
        """Return the host time of a device time. The estimate must have started."""
