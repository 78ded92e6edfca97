# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the protocol on the recording of a real device, intact and damaged."""

from collections import Counter
import random

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat, frame_version
from bahrs_driver.protocol.framing import Framer
import pytest


@pytest.fixture(scope='module')
def frames(recording):
    """Return all frames of the recording."""
    framer = Framer(BahrsFormat())
    return framer.feed(recording) + framer.flush()


def test_all_bytes_are_decoded(recording):
    """None is skipped."""
    frame_format = BahrsFormat()
    framer, codec = Framer(frame_format), BahrsCodec()
    found = [frame for start in range(0, len(recording), 4096)
             for frame in framer.feed(recording[start:start + 4096])]
    assert Counter(codec.decode(frame).NAME for frame in found) == {
        'inertial': 47837, 'navigation': 23919, 'accuracy': 2392,
        'navigation_time': 2392, 'inertial_time': 2392}
    counters = framer.counters
    assert (counters.crc_failures, counters.skipped_bytes, framer.pending) == (0, 0, 0)
    assert frame_format.order_seen == 'word'
    assert {frame_version(frame.data) for frame in found} == {2}


def test_encoding_reproduces_the_recording(recording, frames):
    """Byte for byte."""
    codec = BahrsCodec()
    assert b''.join(codec.encode(codec.decode(frame), 2) for frame in frames) == recording


def test_every_untouched_frame_arrives_and_no_other_does(frames):
    """
    A rough line: noise between frames, a bit flipped in every 50th, one byte at a time.

    The noise is random, with a taste for the bytes of the marker.
    """
    chance, sent, stream = random.Random(20260101), [], bytearray()
    for number, frame in enumerate(frames[:20000]):
        if chance.random() < 0.2:
            noise = chance.randbytes(chance.randrange(1, 40))
            stream += noise.replace(b'\x00', b'N').replace(b'\x01', b'E')
        data = bytearray(frame.data)
        if number % 50 == 0:
            data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
        else:
            sent.append(frame.data)
        stream += data
    framer = Framer(BahrsFormat())
    found = [frame for index in range(len(stream))
             for frame in framer.feed(stream[index:index + 1])]
    assert [frame.data for frame in found + framer.flush()] == sent
    assert framer.counters.crc_failures >= 300
