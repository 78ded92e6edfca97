# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of log times while recording, with clocks that the test sets."""

from bahrs_driver.bag.arrival_clock import ArrivalLogClock, MAX_AGE, MAX_OFFSETS
from bahrs_driver.clock import Instant
from hypothesis import given, strategies as st
import pytest

S, MS = 1_000_000_000, 1_000_000
ROS, RAW = 1_700_000_000 * S, 50 * S


class Host:
    """A host whose clock can be set."""

    def __init__(self):
        """Start with a clock that is right."""
        self.elapsed = self.offset = 0

    def read(self):
        """Return both clocks."""
        return Instant(RAW + self.elapsed, self.ros)

    @property
    def ros(self):
        """ROS time now."""
        return ROS + self.elapsed + self.offset


@pytest.mark.parametrize('step', [-3600 * S, -10 * MS, 10 * MS, 3600 * S])
def test_messages_around_a_step(step):
    """Each has the log time of its arrival, even if it is taken after the step."""
    host = Host()
    clock = ArrivalLogClock(host.read)
    times = []
    for index in range(100):
        host.elapsed = index * 5 * MS
        if index == 50:
            before = host.ros               # arrives just before the clock is set
            host.offset = step
            times.append((index, clock.log_time(clock.now(), before)))
        arrived = host.ros
        host.elapsed += 3 * MS              # and is taken a while later
        times.append((index, clock.log_time(clock.now(), arrived)))
    assert [time - ROS for _, time in times] == [index * 5 * MS for index, _ in times]
    assert len(clock.sentences()) == 1


def test_a_message_that_waited_during_two_steps():
    """The log time is that of the arrival."""
    host = Host()
    clock = ArrivalLogClock(host.read)
    host.elapsed = S
    arrived = host.ros
    for step in (-3600, 7200):
        host.elapsed += S
        host.offset += step * S
        clock.now()
    assert clock.log_time(clock.now(), arrived) == ROS + S


def test_implausible_times():
    """They are ignored, such as those of a wrong clock, and the next given time is used."""
    host = Host()
    clock = ArrivalLogClock(host.read)
    host.elapsed = 100 * S
    now = clock.now()
    for wrong in (None, 0, host.ros + S, host.ros - MAX_AGE - S, -5):
        assert clock.log_time(now, wrong) == now
        assert clock.log_time(now, wrong, host.ros - 7) == now - 7


@given(st.lists(st.tuples(st.integers(0, 10 * S), st.integers(-10 * S, 10 * S),
                          st.integers(0, 100 * S)), min_size=1, max_size=3 * MAX_OFFSETS))
def test_log_time_is_shortly_before_now(moves):
    """This holds for any steps of the clock."""
    host = Host()
    clock, last = ArrivalLogClock(host.read), 0
    for elapsed, step, age in moves:
        host.elapsed, host.offset = host.elapsed + elapsed, host.offset + step
        now = clock.now()
        assert last <= now
        assert now - MAX_AGE <= clock.log_time(now, host.ros - age) <= now
        last = now
