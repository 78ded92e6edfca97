# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of log times: evenly spaced if the clock is set, and never decreasing."""

from bahrs_driver.bag.log_clock import LATEST, LogClock, LogInstant, MAX_STEPS
from hypothesis import given, strategies as st

S = 1_000_000_000
HOUR = 3600 * S
ROS, RAW = 1_700_000_000 * S, 50 * S


def test_a_clock_that_is_only_slewed():
    """Log time is ROS time."""
    clock, slewed = LogClock(), 0
    for index in range(100):
        slewed += 400_000 * (index % 2)         # 8 % of 5 ms
        ros, raw = ROS + index * S // 200 + slewed, RAW + index * S // 200
        assert clock.observe(ros, raw) == LogInstant(ros, ros, raw)
    assert clock.steps == [] and clock.sentences() == []


def test_a_clock_that_is_set_back_and_forward():
    """Each step is reported with its time and size; log times continue evenly."""
    clock = LogClock()
    sets = {20: -HOUR, 50: 7 * S, 70: 24 * HOUR}
    offset = 0
    for index in range(100):
        offset += sets.get(index, 0)
        instant = clock.observe(ROS + index * S + offset, RAW + index * S)
        assert instant.log_ns == ROS + index * S and instant.offset == offset
    assert [(step.seconds, step.size_ns) for step in clock.steps] == list(sets.items())
    assert clock.sentences()[0] == (
        "the host's clock was set by -3600.000000 s, 20.000 s after the beginning: log times go "
        'on evenly, stamps follow the clock')


def test_without_a_steady_clock():
    """Log times keep their order, and their spacing where ROS time increases."""
    clock = LogClock()
    times = [ROS, ROS + S, ROS + S - HOUR, ROS + 2 * S - HOUR]     # the third a second later
    assert [clock.observe(time, None).log_ns - ROS for time in times] == [0, S, 2 * S, 3 * S]
    assert [step.size_ns for step in clock.steps] == [-HOUR - S]


def test_a_host_that_was_restarted():
    """Its steady clock restarts, so log time follows ROS time."""
    clock = LogClock()
    instants = [clock.observe(ROS, 500 * S), clock.observe(ROS + 90 * S, 20 * S),
                clock.observe(ROS + 91 * S, 21 * S)]
    assert [instant.log_ns - ROS for instant in instants] == [0, 90 * S, 91 * S]
    assert [instant.raw_ns for instant in instants] == [500 * S, 590 * S, 591 * S]
    assert clock.steps == []


TIME = st.integers(0, 2 ** 31 * S)


@given(st.lists(st.tuples(st.integers(0, 10 * S), st.integers(-HOUR, HOUR)), min_size=1))
def test_spacing_is_that_of_the_steady_clock(moves):
    """This holds for any steps, except for the amount that slewing may explain."""
    clock, raw, offset = LogClock(), RAW, 0
    last = clock.observe(ROS, RAW).log_ns
    for elapsed, step in moves:
        raw, offset = raw + elapsed, offset + step
        now = clock.observe(ROS + raw - RAW + offset, raw).log_ns
        slew = 500_000 + elapsed // 10
        assert now >= last and abs(now - last - elapsed) <= slew
        last = now
    assert clock.step_count >= sum(abs(step) > 500_000 + elapsed // 10 for elapsed, step in moves)


@given(st.lists(st.tuples(TIME, st.one_of(st.none(), st.integers(0, 2 ** 63 - 1)))))
def test_log_times_never_decrease_and_are_bounded(instants):
    """This holds for any times in labels."""
    clock, last = LogClock(), LogInstant(0, 0, 0)
    for ros, raw in instants:
        instant = clock.observe(ros, raw)
        assert instant.ros_ns == ros
        assert last.log_ns <= instant.log_ns <= LATEST and last.raw_ns <= instant.raw_ns
        last = instant
    assert len(clock.steps) <= MAX_STEPS and len(clock.sentences()) <= MAX_STEPS + 1
