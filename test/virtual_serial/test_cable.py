# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of arrival times, with literal values, at 1,000 bytes per second."""

import math

from bahrs_driver.virtual_serial.cable import adapter_mode, AT_ONCE, Cable, PACKET_BURST, PACKETS
import pytest

BAUD_RATE = 10_000      # a byte a millisecond


def arrivals(cable, until):
    """Return time and bytes of each arrival up to a time."""
    found = []
    while (now := cable.next_time) <= until:
        found.append((round(now, 6), cable.take(now)))
    return found


def test_a_frame_arrives_when_its_last_byte_does():
    """A byte takes ten bit times."""
    cable = Cable(BAUD_RATE)
    cable.send(1.0, b'0123456789')
    assert cable.next_time == pytest.approx(1.010)
    assert arrivals(cable, 2.0) == [(1.010, b'0123456789')]
    assert cable.next_time == math.inf


def test_bytes_leave_back_to_back():
    """Frames wait while the line is busy."""
    cable = Cable(BAUD_RATE)
    cable.send(1.0, b'abcd')
    cable.send(1.001, b'efg')
    cable.send(1.5, b'h')
    assert arrivals(cable, 2.0) == [(1.004, b'abcd'), (1.007, b'efg'), (1.501, b'h')]


def test_a_partial_frame():
    """The bytes that have arrived are returned."""
    cable = Cable(BAUD_RATE)
    cable.send(1.0, b'abcd')
    assert cable.take(1.0025) == b'ab'
    assert cable.take(1.0029) == b''
    assert cable.take(1.003) == b'c'
    assert cable.take(9.0) == b'd'


def test_a_latency_timer_delivers_bursts():
    """Every 16 ms the bytes so far arrive, even in the middle of a frame."""
    cable = Cable(BAUD_RATE, 0.016)
    cable.send(0.010, b'0123456789')
    cable.send(0.021, b'abcdefghij')
    assert arrivals(cable, 1.0) == [(0.016, b'012345'), (0.032, b'6789abcdefghij')]


def test_full_packets_come_together():
    """Eight packets arrive at a time, the rest when the line is idle."""
    cable = Cable(BAUD_RATE, PACKETS)
    cable.send(0.0, bytes(400))
    cable.send(0.4, bytes(400))
    assert [(when, len(data)) for when, data in arrivals(cable, 9.0)] == [
        (0.496, PACKET_BURST), (0.816, 800 - PACKET_BURST)]


def test_a_late_read_gets_all_bursts():
    """A late reader gets all bytes."""
    for mode in (AT_ONCE, PACKETS, 0.016):
        cable = Cable(BAUD_RATE, mode)
        cable.send(0.0, bytes(2000))
        assert len(cable.take(100.0)) == 2000


def test_the_mode_can_change_while_it_runs():
    """Bytes that were held back arrive at once."""
    cable = Cable(BAUD_RATE, 0.255)
    cable.send(0.0, b'abc')
    assert cable.take(0.2) == b''
    cable.mode = AT_ONCE
    assert cable.take(0.2) == b'abc'


def test_unplugging_loses_bytes_on_the_line():
    """Later bytes do not wait for lost ones."""
    cable = Cable(BAUD_RATE)
    cable.send(0.0, b'abcd')
    cable.send(0.0, b'efgh')
    cable.send(0.0, b'ijkl')
    cable.unplug(0.006)
    cable.send(0.1, b'mn')
    assert arrivals(cable, 9.0) == [(0.004, b'abcd'), (0.006, b'ef'), (0.102, b'mn')]


def test_modes_change_only_times():
    """Only the times differ."""
    streams = set()
    for mode in (AT_ONCE, PACKETS, 0.001, 0.016):
        cable = Cable(115200, mode)
        for index in range(300):
            cable.send(index * 0.003, bytes([index % 256]) * 24)
        streams.add(b''.join(data for _, data in arrivals(cable, 10.0)))
    assert len(streams) == 1 and len(streams.pop()) == 7200


@pytest.mark.parametrize(('text', 'mode'), [
    ('none', AT_ONCE), ('packets', PACKETS), ('16', 0.016), ('1', 0.001)])
def test_a_text_becomes_a_mode(text, mode):
    """The text has milliseconds or a name."""
    assert adapter_mode(text) == mode


@pytest.mark.parametrize('text', ['0', '-1', '256', 'much', ''])
def test_an_invalid_text_is_rejected(text):
    """The error is one sentence that lists valid values."""
    with pytest.raises(ValueError, match='from 1 to 255'):
        adapter_mode(text)
