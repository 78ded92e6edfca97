# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run a clock on a simulated device, and compute the errors of its stamps."""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from bahrs_driver.clock import ClockOptions, SampleClock, TimeState
from bahrs_driver.clock.estimation.estimate import Estimate
from bahrs_driver.protocol.bahrs.messages import Inertial
from bahrs_driver.protocol.bahrs.roles import ROLES
from clock_simulation import BYTE_TIME, Case, ORIGIN, Simulation


@dataclass
class Outcome:
    """The outcome of a case. Seconds count from power-on, errors are in us."""

    errors: list[tuple[float, float]]       # of inertial samples, by the time of their read
    state: TimeState
    notices: list[str]
    most_held: int
    backward: int                           # stamps not later than the one before
    future: int                             # stamps later than their read

    def within(self, begin: float, end: float = 1e9) -> list[float]:
        """Return the errors in a span of time."""
        return [error for time, error in self.errors if begin <= time < end]

    def wander(self, begin: float, end: float = 1e9) -> float:
        """Return the 99th percentile of the errors about their median."""
        errors = self.within(begin, end)
        middle = median(errors)
        return sorted(abs(error - middle) for error in errors)[int(0.99 * len(errors))]


def simulated(case: Case, seed: int = 1, options: ClockOptions = ClockOptions(),
              estimate: Estimate | None = None,
              simulation: Callable[[Case, int], Simulation] = Simulation) -> Outcome:
    """Return the outcome of a case, with a live estimate or another one."""
    device, clock = simulation(case, seed), SampleClock(ROLES, options, estimate)
    clock.begin(BYTE_TIME)
    outcome = Outcome([], clock.state(), [], 0, 0, 0)
    last = 0
    for now, received, messages in device.reads():
        clock.observe_read(now, received)
        for message, frame, stamp in clock.stamp(messages):
            if isinstance(message, Inertial):
                truth = case.ros(device.truths[frame.offset])
                outcome.errors.append(((now.raw_ns - ORIGIN) / 1e9, (stamp - truth) / 1000))
                outcome.backward += stamp <= last
                outcome.future += stamp > now.ros_ns
                last = stamp
        outcome.notices += clock.take_notices()
        outcome.most_held = max(outcome.most_held, clock.state().held)
    outcome.state = clock.state()
    return outcome
