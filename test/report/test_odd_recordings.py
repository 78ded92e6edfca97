# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test that there is a page about every recording, however little it contains."""

import random
import warnings

from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy,
    Inertial,
    InertialTime,
    Navigation,
    NvmPage,
    SoftwareVersion,
    SyncPulseTime,
)
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.report.page import page
import pytest
from support.emulated import make_emulation, on_the_wire
from support.recorded import gathered

SAFE = (Integrity.SAFE,) * 6


def inertial(count, health=SAFE):
    """Return inertial messages with the same values."""
    return [Inertial(index % 256, (0.0, 0.0, -9.8), (0.0, 0.0, 0.0), health)
            for index in range(count)]


ODD = {
    'one sample': inertial(1),
    'a repeated sample': inertial(1) * 50,
    'no inertial sample': [Navigation(index % 256, 500.0, 0.0, 0.0, 0.0, 0.0, SAFE[:5])
                           for index in range(300)],
    'no sample at all': [InertialTime(0, 1, 5000), SoftwareVersion('ABC', 1, 2),
                         SyncPulseTime(1, 5), Accuracy(1, None, None, None, 5),
                         NvmPage(0, bytes(32))],
    'an impossible device time': [
        *inertial(1), InertialTime(0, 1, 2 ** 64 - 1), *inertial(1), InertialTime(0, 2, 5000)],
    'contradictory device times of one sample': [
        *inertial(1), InertialTime(0, 1, 5000), InertialTime(0, 1, 5_000_000)],
    'nothing available': inertial(15_000, (Integrity.UNAVAILABLE,) * 6),
    'no noise': inertial(15_000),
}


def make_page(tmp_path, data):
    """Return the page about a recording; a warning of any library fails the test."""
    path = tmp_path / 'odd.bin'
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        return ''.join(page(gathered(open_capture(path))))


@pytest.mark.parametrize('messages', ODD.values(), ids=ODD)
def test_odd_recording(messages, tmp_path):
    """The page is complete."""
    codec = BahrsCodec()
    text = make_page(tmp_path, b''.join(codec.encode(message, 3) for message in messages))
    assert text.endswith('</html>\n') and 'Findings' in text


@pytest.mark.parametrize('seed', range(2))
def test_part_of_a_damaged_recording(seed, tmp_path):
    """The page is complete wherever the recording begins and ends."""
    chance = random.Random(seed)
    data = bytearray(on_the_wire(make_emulation(), 6.0)[1])
    begin = chance.randrange(len(data) // 2)
    piece = data[begin:begin + chance.choice([100, 1000, 20_000])]
    for _ in range(10):
        piece[chance.randrange(len(piece))] ^= 1 << chance.randrange(8)
    assert make_page(tmp_path, bytes(piece)).endswith('</html>\n')
