# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The host's two clocks: one that nobody touches, and the one that all nodes agree on.

Everything is estimated on CLOCK_MONOTONIC_RAW. ROS time is set and slewed by others, and is put
in at the very end, so that doing so to it costs nothing.
"""

from bahrs_driver.clock.interface import Instant
from bahrs_driver.units import NS_PER_MS, NS_PER_S

STEP = NS_PER_MS / 2        # ns; a change above this, and above the fastest slew, is a step
FASTEST_SLEW = 0.1          # what chrony and adjtime do is below


def step_sentence(step: int) -> str:
    """Return a sentence for the user about a step of ROS time by so many ns."""
    return f"the host's clock was set by {step / NS_PER_S:+.6f} s"


def step_between(earlier: Instant, later: Instant) -> int:
    """Return by how many ns ROS time was set between two moments; 0 if it was slewed at most."""
    elapsed = later.raw_ns - earlier.raw_ns
    change = later.ros_ns - earlier.ros_ns - elapsed
    return change if abs(change) > STEP + FASTEST_SLEW * elapsed else 0


class HostClocks:
    """Remembers the last two reads of both clocks, and goes straight between them."""

    def __init__(self) -> None:
        self.steps = 0
        self.last_step_ns = 0
        self._before = self._after = Instant(0, 0)
        self._started = False

    def read(self, now: Instant) -> int:
        """Take both clocks at one moment; return by how many ns ROS time was stepped, or 0."""
        step = step_between(self._after, now) if self._started else 0
        self._before = now if step or not self._started else self._after
        self._after = now
        self._started = True
        if step:
            self.steps += 1
            self.last_step_ns = step
        return step

    def ros(self, raw: int) -> int:
        """Return the ROS time at a raw time."""
        before, after = self._before, self._after
        offset = before.ros_ns - before.raw_ns
        change = after.ros_ns - after.raw_ns - offset
        elapsed = after.raw_ns - before.raw_ns
        if change and elapsed > 0:
            offset += change * max(0, min(raw - before.raw_ns, elapsed)) // elapsed
        return raw + offset
