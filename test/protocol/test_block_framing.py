# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Framing of blocks gives the frames and counters of the framer, for any bytes."""

from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import Framer
from hypothesis import given, strategies as st
import numpy as np
import pytest
from support.independent import (
    chunk_sizes, chunks, debug_frames, known_frames, make_frame, noise,
    stream_frames,
)

FRAME = make_frame(2, 0x06, bytes(9))


def by_blocks(pieces, order):
    """Return the frames of block framing in order of offset, the framer, and its format."""
    frame_format = BahrsFormat(order)
    framer, frames = BlockFramer(frame_format), []
    for piece in pieces:
        for found in framer.feed(piece):
            if isinstance(found, FrameBlock):
                frames += [(offset, row.tobytes())
                           for offset, row in zip(found.offsets.tolist(), found.rows)]
                assert all(frame.startswith(found.header) for _, frame in frames[-len(found[1]):])
            else:
                frames += [(frame.offset, frame.data) for frame in found]
    frames += [(frame.offset, frame.data) for frame in framer.flush()]
    return sorted(frames), framer.framer, frame_format


def check(stream, sizes, order='auto'):
    """Compare with a framer that gets the stream at once."""
    frames, framer, frame_format = by_blocks(chunks(stream, sizes), order)
    reference_format = BahrsFormat(order)
    reference = Framer(reference_format)
    expected = reference.feed(stream) + reference.flush()
    assert frames == [(frame.offset, frame.data) for frame in expected]
    assert framer.counters == reference.counters
    assert framer.received == len(stream)
    assert frame_format.order_seen == reference_format.order_seen
    assert frame_format.version_seen == reference_format.version_seen


@given(st.lists(known_frames() | debug_frames() | noise(), max_size=12),
       chunk_sizes(), st.sampled_from(['auto', 'word', 'byte']))
def test_any_stream(parts, sizes, order):
    """Frames of all types and both orders, damaged frames, unknown types and noise."""
    check(b''.join(parts), sizes, order)


@given(st.lists(stream_frames(), min_size=1, max_size=8), st.binary(max_size=60),
       st.integers(1, 30), chunk_sizes())
def test_long_runs_with_gaps(frames, gap, repetitions, sizes):
    """The chain is resumed after each gap."""
    check((b''.join(frames) + gap) * repetitions, sizes)


def test_frame_inside_an_intact_one_is_part_of_it():
    """A memory page may hold a whole frame."""
    inner = make_frame(2, 0x02, bytes(8))
    outer = make_frame(3, 0x1F, inner[:14])
    check((outer + FRAME) * 5, [1000])
    page = make_frame(3, 0xF3, b'\x07' + inner + bytes(32 - len(inner)))
    check((page + FRAME) * 5, [1000])


@pytest.mark.parametrize('size', [1, 28, 29, 1000, 65536, 10 ** 7])
def test_recording(recording, size):
    """The recording in blocks of any size, intact and with damage to every 20th frame."""
    begin = recording[:max(20_000, 500 * size)]
    check(begin, [size])
    damaged = bytearray(begin)
    rng = np.random.default_rng(5)
    for place in rng.integers(0, len(damaged), len(damaged) // 500):
        damaged[place] ^= 1 << int(rng.integers(8))
    check(bytes(damaged), [size])
