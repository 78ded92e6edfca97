# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of stamps for answers, with literal times."""

from types import SimpleNamespace

from bahrs_driver.clock import ExchangeClock, Instant
from bahrs_driver.protocol.framing import Frame

US, MS, S = 1_000, 1_000_000, 1_000_000_000
BYTE = 100 * US
ROS = 5000 * S


def begun(latency=0):
    """Return a clock of a line with 100 us per byte, and of requests of 8 bytes."""
    clock = ExchangeClock(8, latency)
    clock.begin(BYTE)
    return clock


def stamp(clock, requested_at, time, offset, size, offset_ros=ROS, expected=True):
    """Return the stamp of a frame that a read completed."""
    clock.observe_read(Instant(time, time + offset_ros), offset + size)
    message = SimpleNamespace(requested_at=requested_at, expected=expected)
    (_, _, stamped), = clock.stamp([(message, Frame(offset, bytes(size), 'big'))])
    return stamped - offset_ros


def test_the_stamp_is_the_middle_of_request_and_answer():
    """A request from 10 to 10.8 ms and an answer from 12.8 to 17.8 ms give 11.8 ms."""
    clock = begun()
    assert stamp(clock, 10 * MS, 17_800 * US, 0, 50) == 11_800 * US
    state = clock.state()
    assert (state.in_use, state.settled, state.spread_us) == ('exchange', True, 1000.0)


def test_a_read_within_an_answer_tightens_the_bound():
    """The adapter delayed the last part only."""
    clock = begun()
    clock.observe_read(Instant(13 * MS, 13 * MS + ROS), 20)         # begun at 11 ms at the latest
    assert stamp(clock, 10 * MS, 30 * MS, 0, 50) == 10_900 * US


def test_a_line_that_is_faster_than_its_baud_rate():
    """On a pseudo-terminal the transmission time is ignored."""
    clock = begun()
    assert stamp(clock, 10 * MS, 11 * MS, 0, 50) == 10_500 * US


def test_without_a_request_the_stamp_is_the_arrival():
    """The transmission time is subtracted, and such stamps are counted."""
    clock = begun()
    assert stamp(clock, None, 17 * MS, 0, 50) == 12 * MS
    assert clock.state().arrival_stamps == 1


def test_an_unexpected_answer_does_not_delay_others():
    """A late answer has a later stamp than an answer requested before it arrived."""
    clock = begun()
    assert stamp(clock, None, 17 * MS, 0, 50, expected=False) == 12 * MS
    assert stamp(clock, 10 * MS, 17_800 * US, 50, 50) == 11_800 * US
    assert clock.state().arrival_stamps == 0


def test_latency_is_subtracted_and_stamps_increase():
    """Stamps increase strictly for any reads."""
    clock = begun(latency=MS)
    first = stamp(clock, 10 * MS, 17_800 * US, 0, 50)
    assert first == 10_800 * US
    assert stamp(clock, 10 * MS, 17_800 * US, 50, 50) == first + 1


def test_stamps_follow_a_step_of_the_host_clock_and_it_is_reported():
    """The clock is set back."""
    clock = begun()
    stamp(clock, 10 * MS, 17_800 * US, 0, 50)
    assert stamp(clock, 110 * MS, 117_800 * US, 50, 50, ROS - 7 * S) == 111_800 * US
    assert clock.take_notices() == ["the host's clock was set by -7.000000 s"]
    assert clock.take_notices() == [] and clock.state().host_steps == 1
