# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The two clocks of the host: the raw clock, which is never set, and ROS time, shared by all nodes.

Everything is estimated on CLOCK_MONOTONIC_RAW and converted to ROS time at the very end, so a
host clock that is set or slewed does not disturb the estimate.
"""

from bahrs_driver.clock.interface import Instant
from bahrs_driver.units import NS_PER_MS, NS_PER_S

STEP = NS_PER_MS / 2        # ns; a change above this, and above the fastest slew, is a step
FASTEST_SLEW = 0.1          # chrony and adjtime slew more slowly


def step_sentence(step: int) -> str:
    """Return the notice of a step of ROS time by so many ns."""
    return f"the host's clock was set by {step / NS_PER_S:+.6f} s"


def step_between(earlier: Instant, later: Instant) -> int:
    """Return by how many ns ROS time was set between two instants; 0 if it was slewed at most."""
    elapsed = later.raw_ns - earlier.raw_ns
    change = later.ros_ns - earlier.ros_ns - elapsed
    return change if abs(change) > STEP + FASTEST_SLEW * elapsed else 0


class HostClocks:
    """Converts raw time to ROS time, linearly between the latest two reads."""

    def __init__(self) -> None:
        self.steps = 0
        self.last_step_ns = 0
        self._before = self._after = Instant(0, 0)
        self._started = False

    def observe_read(self, now: Instant) -> int:
        """Record the instant of a read; return by how many ns ROS time was set, or 0."""
        step = step_between(self._after, now) if self._started else 0
        self._before = now if step or not self._started else self._after
        self._after = now
        self._started = True
        if step:
            self.steps += 1
            self.last_step_ns = step
        return step

    def to_ros_time(self, raw: int) -> int:
        """Convert a raw time to ROS time."""
        before, after = self._before, self._after
        offset = before.ros_ns - before.raw_ns
        change = after.ros_ns - after.raw_ns - offset
        elapsed = after.raw_ns - before.raw_ns
        if change and elapsed > 0:
            offset += change * max(0, min(raw - before.raw_ns, elapsed)) // elapsed
        return raw + offset
