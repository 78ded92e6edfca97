# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Compute log times that keep order and spacing if the host's clock is set.

ROS time is the host's wall clock, which may be set in the middle of a recording. Players and
tools use log times, and would wait for an hour or play everything at once. So a log time is ROS
time minus all steps since the beginning of the recording: it follows a clock that is slewed, and
continues evenly over one that is set. Stamps of messages do not change.
"""

from typing import NamedTuple

from bahrs_driver.clock import Instant
from bahrs_driver.clock.host import step_between, step_sentence
from bahrs_driver.units import NS_PER_S

MAX_STEPS = 20          # kept; more are only counted
LATEST = 2 ** 62        # ns; the limit of log times, for any recording


class LogInstant(NamedTuple):
    """One instant of a recording on its three clocks, in ns."""

    log_ns: int         # never goes back
    ros_ns: int         # as set at that time
    raw_ns: int         # on a steady clock; never goes back
    offset: int = 0     # sum of the steps of ROS time before


class Step(NamedTuple):
    """A step of ROS time."""

    seconds: float      # since the beginning of the recording
    size_ns: int


class LogClock:
    """Assigns log times to successive instants."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.step_count = 0
        self._first: LogInstant | None = None
        self._last = LogInstant(0, 0, 0)
        self._raw_ns: int | None = None     # of the last instant, as passed to observe()
        self._elapsed = 0                   # between the last two instants

    def observe(self, ros_ns: int, raw_ns: int | None) -> LogInstant:
        """Return an instant with its log time; raw_ns is CLOCK_MONOTONIC_RAW, None if unknown."""
        if self._first is None:
            steady_ns = ros_ns if raw_ns is None else raw_ns
            self._first = self._last = LogInstant(ros_ns, ros_ns, steady_ns)
        else:
            self._advance(ros_ns, raw_ns)
        self._raw_ns = raw_ns
        return self._last

    def sentences(self) -> list[str]:
        """Return a sentence for each step, for the user."""
        found = [f'{step_sentence(step.size_ns)}, {step.seconds:.3f} s after the beginning: log '
                 'times go on evenly, stamps follow the clock' for step in self.steps]
        if self.step_count > len(self.steps):
            more = self.step_count - len(self.steps)
            found.append(f"the host's clock was set {more} more times")
        return found

    def _advance(self, ros_ns: int, raw_ns: int | None) -> None:
        last = self._last
        if raw_ns is None or self._raw_ns is None or raw_ns < self._raw_ns:
            # The elapsed time is unknown: assume the one before if ROS time has gone back.
            elapsed = ros_ns - last.ros_ns if ros_ns >= last.ros_ns else self._elapsed
        else:
            elapsed = raw_ns - self._raw_ns
        self._elapsed = elapsed
        steady_ns = last.raw_ns + elapsed
        step = step_between(Instant(last.raw_ns, last.ros_ns), Instant(steady_ns, ros_ns))
        offset = last.offset + step
        log_ns = min(LATEST, max(last.log_ns, ros_ns - offset))
        self._last = LogInstant(log_ns, ros_ns, steady_ns, offset)
        if step:
            self._add_step(step)

    def _add_step(self, size_ns: int) -> None:
        assert self._first
        self.step_count += 1
        if len(self.steps) < MAX_STEPS:
            seconds = (self._last.log_ns - self._first.log_ns) / NS_PER_S
            self.steps.append(Step(seconds, size_ns))
