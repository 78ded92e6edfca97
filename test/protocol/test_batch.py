# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of batch decoding: the same values as decoding one by one, to the last bit."""

from collections import Counter
import dataclasses
from dataclasses import dataclass
import math
from unittest import mock

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Accuracy, Inertial, layouts, MESSAGES, Navigation
from bahrs_driver.protocol.batch import Batch, table
from bahrs_driver.protocol.block_framing import BlockFramer, FrameBlock
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.protocol.layout import (
    integer, integers, Layout, real, reals, scaled, text, Vector, vector, wire,
)
from bahrs_driver.protocol.titan_m.frames import LAYOUTS as TITAN_LAYOUTS
from hypothesis import given, strategies as st
import numpy as np
from support.independent import chunk_sizes, chunks, debug_frames, known_frames, noise
from support.shared_files import shared_file

LAYOUTS = [*layouts().values(), *layouts('int16').values(), *TITAN_LAYOUTS.values()]


@dataclass(frozen=True, slots=True)
class Strange:
    """A message of another device, with other rows and another byte order."""

    name: str = wire(text(4))
    force: Vector = wire(vector('i', 1e-6, 'm/s^2'))
    height: float = wire(scaled('I', 0.001, 'm', -500.0))
    latitude: float = wire(real('d', 'degree'))
    field: tuple[float, float, float] = wire(reals('f', 3, 'T'))
    counts: tuple[int, int] = wire(integers('H', 2))
    signed: int = wire(integer('b'))


def same(value, element):
    """Return whether an element of an array equals the value decoded by the codec."""
    if isinstance(value, tuple):
        return len(value) == len(element) and all(map(same, value, element))
    if value is None or isinstance(value, float) and math.isnan(value):
        return math.isnan(element)
    return value == element


def check(layout, payloads, columns):
    """Compare every field of every message."""
    assert {len(column) for column in columns.values()} == {len(payloads)}
    for index, payload in enumerate(payloads):
        message = layout.decode(payload)
        for item in dataclasses.fields(layout.message):
            assert same(getattr(message, item.name), columns[item.name][index]), item.name


@given(layout=st.sampled_from([*LAYOUTS, Layout(Strange), Layout(Strange, byte_order='>')]),
       data=st.data())
def test_any_bytes_are_decoded_as_by_the_codec(layout, data):
    """For every message of every version, and for a device with other rows."""
    payloads = data.draw(st.lists(
        st.binary(min_size=layout.size, max_size=layout.size), max_size=5))
    offsets = np.arange(len(payloads)) * 10
    columns = table(layout, b''.join(payloads), offsets)
    check(layout, payloads, columns)
    assert columns['offset'].tolist() == offsets.tolist()


def test_columns():
    """Vectors and health have their components; invalid values are NaN."""
    codec = BahrsCodec()
    safe = (Integrity.SAFE,) * 5 + (Integrity.INTEGRITY_RISK,)
    messages = [Inertial(3, (0.0, 1.4964e-3, 0.0), (0.0, 0.0, 0.0), safe),
                Accuracy(4, None, 9.587526e-5, None, 10 ** 15)]
    framer, batch = Framer(BahrsFormat()), Batch(codec.layouts_by_header)
    batch.add(framer.feed(b''.join(codec.encode(message, 3) for message in messages)))
    inertial, accuracy = batch.take(Inertial), batch.take(Accuracy)
    assert inertial['specific_force'].shape == (1, 3)
    assert inertial['specific_force'][0, 1] == 1.4964e-3
    assert inertial['health'].tolist() == [[1, 1, 1, 1, 1, 2]]
    assert np.isnan(accuracy['north_std'][0]) and accuracy['east_std'][0] == 9.587526e-5
    assert accuracy['device_time_us'][0] == 10 ** 15
    assert {len(column) for column in batch.take(Navigation).values()} == {0}


def test_versions_mixed():
    """Messages are in stream order, each with the scale of its version."""
    codec, framer = BahrsCodec(), Framer(BahrsFormat())
    force, safe = (1.0, 2.0, 3.0), (Integrity.SAFE,) * 6
    sent = [(Inertial(index, force, (0.0, 0.0, 0.0), safe), 2 + index % 2) for index in range(9)]
    batch = Batch(codec.layouts_by_header)
    frames = framer.feed(b''.join(codec.encode(*each) for each in sent))
    batch.add(frames)
    assert sorted(batch.counts().values()) == [4, 5]
    columns = batch.take(Inertial)
    assert columns['sequence'].tolist() == list(range(9))
    for frame, force in zip(frames, columns['specific_force']):
        assert same(codec.decode(frame).specific_force, force)


def test_a_whole_recording():
    """Counts and values of every message of a real device."""
    data = shared_file('data/bahrs_recording_v2.bin').read_bytes()
    codec, framer = BahrsCodec(), Framer(BahrsFormat())
    batch, blocks = Batch(codec.layouts_by_header), Batch(codec.layouts_by_header)
    frames = framer.feed(data) + framer.flush()
    batch.add(frames)
    block_framer = BlockFramer(BahrsFormat())
    for start in range(0, len(data), 300_000):
        for found in block_framer.feed(data[start:start + 300_000]):
            (blocks.add_block if isinstance(found, FrameBlock) else blocks.add)(found)
    assert blocks.counts() == batch.counts()
    for kind in MESSAGES:
        wanted = [frame for frame in frames if frame.data[4] == kind.TYPE]
        columns = batch.take(kind)
        assert all(np.array_equal(columns[name], column, equal_nan=column.dtype.kind == 'f')
                   for name, column in blocks.take(kind).items())
        assert columns['offset'].tolist() == [frame.offset for frame in wanted]
        for index in range(0, len(wanted), 97):
            message = codec.decode(wanted[index])
            assert all(same(getattr(message, item.name), columns[item.name][index])
                       for item in dataclasses.fields(kind))


@given(st.lists(known_frames() | debug_frames() | noise(), max_size=12), chunk_sizes(),
       st.integers(1, 40))
def test_any_stream_in_blocks(parts, sizes, pending):
    """Damaged, repeated and mixed frames: the messages of the codec, in their order."""
    stream = b''.join(parts) * 2
    codec, framer, blocks = BahrsCodec(), Framer(BahrsFormat()), BlockFramer(BahrsFormat())
    frames = framer.feed(stream) + framer.flush()
    batch = Batch(codec.layouts_by_header)
    with mock.patch('bahrs_driver.protocol.batch._PENDING', pending):
        for piece in chunks(stream, sizes):
            for found in blocks.feed(piece):
                (batch.add_block if isinstance(found, FrameBlock) else batch.add)(found)
        batch.add(blocks.flush())
    assert batch.counts() == Counter(frame.data[:5] for frame in frames)
    for kind in MESSAGES:
        wanted = [(frame.offset, codec.decode(frame)) for frame in frames
                  if frame.data[4] == kind.TYPE]
        columns = batch.take(kind)
        assert columns['offset'].tolist() == [offset for offset, _ in wanted]
        for index, (_, message) in enumerate(wanted):
            assert all(same(getattr(message, item.name), columns[item.name][index])
                       for item in dataclasses.fields(kind))


def test_reals_of_half_the_size():
    """Rounded from the exact values."""
    layout = layouts()[3, Inertial.TYPE]
    payloads = bytes(range(layout.size * 4))
    exact = table(layout, payloads, np.arange(4))
    rounded = table(layout, payloads, np.arange(4), np.float32)
    for name, column in exact.items():
        expected = column.astype(np.float32) if column.dtype == np.float64 else column
        assert rounded[name].dtype == expected.dtype
        assert np.array_equal(rounded[name], expected)
