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
    """Return a clock on a line of 100 us a byte, and of requests of 8 bytes."""
    clock = ExchangeClock(8, latency)
    clock.begin(BYTE)
    return clock


def stamp(clock, asked, time, offset, size, offset_ros=ROS, wanted=True):
    """Return the stamp of a frame that a read at a time has completed."""
    clock.observe_read(Instant(time, time + offset_ros), offset + size)
    message = SimpleNamespace(asked=asked, wanted=wanted)
    (_, _, stamped), = clock.stamp([(message, Frame(offset, bytes(size), 'big'))])
    return stamped - offset_ros


def test_the_middle_of_request_and_answer_less_their_time_on_the_line():
    """Asked at 10 ms, heard at 10.8; answer of 5 ms complete at 17.8, begun at 12.8."""
    clock = begun()
    assert stamp(clock, 10 * MS, 17_800 * US, 0, 50) == 11_800 * US
    state = clock.state()
    assert (state.in_use, state.settled, state.spread_us) == ('exchange', True, 1000.0)


def test_a_read_in_the_midst_of_an_answer_tells_more():
    """The last part was held back; the first was not."""
    clock = begun()
    clock.observe_read(Instant(13 * MS, 13 * MS + ROS), 20)         # begun at 11 ms at the latest
    assert stamp(clock, 10 * MS, 30 * MS, 0, 50) == 10_900 * US


def test_a_line_that_is_faster_than_it_says():
    """A pseudo-terminal: then the line's time does not count at all."""
    clock = begun()
    assert stamp(clock, 10 * MS, 11 * MS, 0, 50) == 10_500 * US


def test_without_a_request_it_is_the_arrival():
    """Less the time on the line; such are counted."""
    clock = begun()
    assert stamp(clock, None, 17 * MS, 0, 50) == 12 * MS
    assert clock.state().arrival_stamps == 1


def test_what_nobody_waits_for_does_not_hold_up_the_others():
    """An answer that came late has a later stamp than what was asked for before it came."""
    clock = begun()
    assert stamp(clock, None, 17 * MS, 0, 50, wanted=False) == 12 * MS
    assert stamp(clock, 10 * MS, 17_800 * US, 50, 50) == 11_800 * US
    assert clock.state().arrival_stamps == 0


def test_latency_is_taken_off_and_stamps_increase():
    """Strictly, whatever the reads say."""
    clock = begun(latency=MS)
    first = stamp(clock, 10 * MS, 17_800 * US, 0, 50)
    assert first == 10_800 * US
    assert stamp(clock, 10 * MS, 17_800 * US, 50, 50) == first + 1


def test_a_host_clock_that_is_set_is_told_and_followed():
    """Backward, too."""
    clock = begun()
    stamp(clock, 10 * MS, 17_800 * US, 0, 50)
    assert stamp(clock, 110 * MS, 117_800 * US, 50, 50, ROS - 7 * S) == 111_800 * US
    assert clock.take_notices() == ["the host's clock was set by -7.000000 s"]
    assert clock.take_notices() == [] and clock.state().host_steps == 1
