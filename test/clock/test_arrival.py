# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the arrival clock, with literal pairs."""

from bahrs_driver.clock import ArrivalClock, Instant
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.units import byte_time_ns
import pytest


def arrivals(byte_time, *reads):
    """Return the stamps of frames, each with the time of its read and the bytes since it began."""
    clock, stamps = ArrivalClock(), []
    clock.begin(byte_time)
    for received, (time, bytes_since) in zip(range(10_000, 10 ** 6, 10_000), reads):
        clock.observe_read(Instant(time, time), received)
        stamps += clock.stamp([('message', Frame(received - bytes_since, b'', 'word'))])
    return [item.stamp_ns for item in stamps]


@pytest.mark.parametrize('baud_rate, expected', [(115200, 86805), (9600, 1041666), (0, 0)])
def test_byte_time(baud_rate, expected):
    """Ten bits per byte; 0 without a baud rate."""
    assert byte_time_ns(baud_rate) == expected


@pytest.mark.parametrize('read_time, bytes_since, expected', [
    (5_000_000_000, 24, 4_997_916_680),     # a frame that ends its chunk
    (5_000_000_000, 48, 4_995_833_360),     # a frame with as many bytes after it
    (5_000_000_000, 0, 5_000_000_000),
])
def test_stamp_is_the_read_minus_the_transmission_time(read_time, bytes_since, expected):
    """From the first byte of the frame to the last byte of the chunk."""
    assert arrivals(86805, (read_time, bytes_since)) == [expected]


def test_without_a_line_rate_the_stamp_is_the_read():
    """Native USB and networks have no line rate."""
    assert arrivals(0, (5_000_000_000, 4096)) == [5_000_000_000]


def test_stamps_increase_strictly():
    """Two chunks arrive in quick succession, or frames have the same time."""
    assert arrivals(100, (1000, 5), (1001, 9), (1001, 9), (5000, 0)) == [500, 501, 502, 5000]


def test_stamps_follow_a_host_clock_that_was_set_back():
    """The host's clock was set by more than a second."""
    times = [9_000_000_000, 7_000_000_000, 7_000_000_001]
    assert arrivals(0, *((time, 0) for time in times)) == times


def test_stamps_follow_a_step_of_the_host_clock_and_it_is_reported():
    """The clock was set back by half a second."""
    clock, stamps = ArrivalClock(), []
    for index, (raw, ros) in enumerate([(0, 9_000), (10, 9_010), (20, 8_520), (30, 8_530)]):
        clock.observe_read(Instant(raw * 1_000_000, ros * 1_000_000), index + 1)
        stamps += clock.stamp([('message', Frame(index + 1, b'', 'word'))])
    assert [item.stamp_ns // 1_000_000 for item in stamps] == [9_000, 9_010, 8_520, 8_530]
    assert clock.take_notices() == ["the host's clock was set by -0.500000 s"]
    assert clock.take_notices() == [] and clock.state().host_steps == 1
