# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the schedule of a recorded stream."""

from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.virtual_serial.cable import Cable
from bahrs_driver.virtual_serial.faults import Faults
from bahrs_driver.virtual_serial.pacing import pace, transmit
import pytest
from support.emulated import emissions, make_device


def paced(chunks):
    """Return the bytes of a BAHRS, with their times."""
    spec = DEVICES['bahrs']
    return pace(chunks, Framer(spec.frame_format()), spec.frame_period)


def test_an_emulated_stream_gets_its_own_times_back():
    """No byte is missing, and each sample is due 5 ms after the previous one."""
    sent = emissions(make_device(), 3.0)
    data = b''.join(emission.data for emission in sent)
    pieces = list(paced([data[:5000], data[5000:]]))
    assert b''.join(piece for _, piece in pieces) == data
    assert [due for due, _ in pieces] == pytest.approx([0.005 * index
                                                        for index in range(len(pieces))])
    assert pieces[-1][0] == pytest.approx(2.4, abs=0.011)


def test_bytes_without_frames_are_due_at_once():
    """They stay in one piece."""
    assert list(paced([b'nothing in', b' here'])) == [(0.0, b'nothing in here')]
    assert list(paced([])) == [(0.0, b'')]


def test_over_a_good_cable():
    """Each frame arrives when the line has sent it."""
    pieces = [(0.0, b'abc'), (1.0, b'de'), (1.0, b'f')]
    arrived = list(transmit(pieces, Cable(115200), Faults(1), Framer(BahrsFormat())))
    assert b''.join(data for _, data in arrived) == b'abcdef'
    assert arrived[-1][0] == pytest.approx(1.0, abs=0.001)


def test_over_a_faulty_cable():
    """Whole frames are lost, and the adapter holds bytes back."""
    data = b''.join(emission.data for emission in emissions(make_device(), 3.0))
    faults = Faults(1, {'drop_frame': 0.5})
    arrived = list(transmit(paced([data]), Cable(115200, 0.016), faults, Framer(BahrsFormat())))
    framer = Framer(BahrsFormat())
    frames = framer.feed(b''.join(piece for _, piece in arrived))
    assert framer.counters.skipped_bytes == 0
    assert len(frames) + faults.counts['drop_frame'] == len(Framer(BahrsFormat()).feed(data))
    assert all(abs(due / 0.016 - round(due / 0.016)) < 1e-6 for due, _ in arrived)
