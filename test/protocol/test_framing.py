# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Tests of the framer, on BAHRS frames generated independently of it.

It must not lose an intact frame, return a false one, depend on the division into chunks, or lose
count of the bytes.
"""

from collections import Counter
import zlib

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.framing import Framer
from hypothesis import example, given, strategies as st
import pytest
from support.independent import (
    chunk_sizes,
    chunks,
    debug_frames,
    flipped_frames,
    HEADER_SIZE,
    known_frames,
    LONGEST_FRAME,
    make_frame,
    noise,
    properties,
    service_frames,
    stream_frames,
)

FIRST_FRAME = bytes.fromhex('4e45020001 00 d5ffe2ff8ae6 fcff02000700 3f 00 f65b0c0a')
PULSE = make_frame(2, 0x06, bytes(9))
PAGE_HEADER = b'NE\x03\x00\xF3'     # a candidate of 42 or 44 bytes
DEBUG_C1 = bytes.fromhex('4e450200c1 01 404b4c0000000000 0000 649d990a')
DEBUG_C0 = bytes.fromhex('4e450300c0 01 404b4c0000000000 0500 68656c6c6f 000000 07be6859')


class Run:
    """The result of a new framer for a stream."""

    def __init__(self, pieces, order='auto', flush=True, **options):
        """Feed the pieces one after another."""
        self.framer = Framer(BahrsFormat(order), **options)
        self.frames = [frame for piece in pieces for frame in self.framer.feed(piece)]
        if flush:
            self.frames += self.framer.flush()
        self.data = [frame.data for frame in self.frames]
        self.counters = self.framer.counters


def accounted(framer):
    """Return the sum of all byte counts of a framer."""
    counters = framer.counters
    return (counters.frame_bytes + counters.unknown_bytes + counters.skipped_bytes
            + framer.pending)


def streams():
    """Draw streams of known, unknown and broken frames, and noise."""
    return st.lists(known_frames() | debug_frames() | noise(), max_size=8).map(b''.join)


@st.composite
def hostile_bytes(draw):
    """Draw long noise that a framer keeps: markers, headers of unknown types and long frames."""
    piece = st.sampled_from((
        b'N', b'E', b'NE', b'\x00', PAGE_HEADER, b'NE\x02\x00\xC0', b'NE\x04\x00\x01', bytes(30),
        b'NE\x03\x00\xF0', b'NE\x03\x00\xF1\x00\x00\x00', bytes(300), DEBUG_C1))
    return b''.join(draw(st.lists(piece, max_size=30))) * draw(st.integers(1, 8))


# Frames

def test_a_frame_is_delivered_with_its_last_byte():
    """Neither earlier nor later."""
    framer = Framer(BahrsFormat())
    assert framer.feed(FIRST_FRAME[:-1]) == []
    (frame,) = framer.feed(FIRST_FRAME[-1:])
    assert (frame.offset, frame.data, frame.checksum, frame.end) == (0, FIRST_FRAME, 'word', 24)


def test_no_bytes_give_no_frames():
    """A flush gives none either."""
    run = Run([b'', b''])
    assert (run.frames, run.framer.received, run.framer.pending) == ([], 0, 0)


@properties(150)
@given(known_frames())
def test_a_known_frame_is_found_byte_by_byte(frame):
    """For every message, version, checksum and padding."""
    assert Run(bytes([byte]) for byte in frame).data == [frame]


@properties(100)
@given(service_frames(), st.sampled_from(('auto', 'word', 'byte')))
def test_service_frames_are_found_in_all_variants_under_any_order(frame, order):
    """A forced order applies only to the stream."""
    assert Run([FIRST_FRAME, frame, PULSE], order).data.count(frame) == 1


@properties(250)
@given(st.lists(st.tuples(noise(), known_frames()), max_size=5), noise())
def test_intact_frames_amid_noise_are_found_in_order_and_nothing_else(parts, end):
    """This is the contract of the framer."""
    run = Run([b''.join(before + frame for before, frame in parts) + end])
    assert run.data == [frame for _, frame in parts]


@properties(100)
@given(streams())
def test_offset_and_end_are_positions_in_the_stream(stream):
    """The end is that of the byte after the frame."""
    for frame in Run([stream]).frames:
        assert stream[frame.offset:frame.end] == frame.data


@properties(150)
@given(st.lists(known_frames(), min_size=1, max_size=4), st.data())
def test_flipped_bits_lose_only_the_frame_that_they_are_in(frames, data):
    """Wherever they are, including the header."""
    index = data.draw(st.integers(0, len(frames) - 1))
    broken = data.draw(flipped_frames(st.just(frames[index])))
    run = Run(frames[:index] + [broken] + frames[index + 1:])
    assert run.data == frames[:index] + frames[index + 1:]
    assert run.counters.skipped_bytes + run.counters.unknown_bytes == len(broken)


@pytest.mark.parametrize('bit', range(8 * len(FIRST_FRAME)))
def test_each_bit_matters(bit):
    """Including those of padding and checksum."""
    broken = bytearray(FIRST_FRAME)
    broken[bit // 8] ^= 1 << bit % 8
    assert Run([PULSE, bytes(broken), PULSE]).data == [PULSE, PULSE]


@pytest.mark.parametrize('lead', [
    b'N', b'NN', b'NNNN', b'NEN', b'NENE', b'E', b'NE\x02', b'NE\x02\x00', b'NE\x02\x00\x01',
    b'NNE', PAGE_HEADER, b'\x4e' * 43])
@pytest.mark.parametrize('size', [1, 2, 3, 1000])
def test_the_beginning_of_a_marker_before_a_frame_does_not_hide_it(lead, size):
    """N N E: the second N is the first of the marker."""
    assert Run(chunks(lead + FIRST_FRAME + PULSE, [size])).data == [FIRST_FRAME, PULSE]


@pytest.mark.parametrize('cut', range(1, len(FIRST_FRAME)))
def test_a_truncated_frame_costs_nothing_but_itself(cut):
    """The bytes that it claims belong to the next frame."""
    run = Run([FIRST_FRAME[:cut] + PULSE + PULSE])
    assert (run.data, run.counters.skipped_bytes) == ([PULSE, PULSE], cut)


def test_a_frame_inside_the_bytes_that_a_broken_one_claims_is_found():
    """A failed candidate costs its marker, never its length."""
    run = Run([PAGE_HEADER + b'\x00' + FIRST_FRAME + bytes(14)])
    assert run.data == [FIRST_FRAME]
    assert run.counters.crc_failures == 1


def test_a_frame_inside_an_intact_one_is_part_of_it():
    """A page of the memory may contain anything."""
    page = make_frame(3, 0xF3, b'\x07' + FIRST_FRAME + bytes(8), 'crc32', padded=False)
    assert Run([page]).data == [page]


# Chunks

@properties(200)
@given(streams(), chunk_sizes())
def test_chunks_of_any_size_give_the_same_frames_and_counters(stream, sizes):
    """The result equals that of the whole stream at once."""
    whole, cut = Run([stream]), Run(chunks(stream, sizes))
    assert cut.frames == whole.frames
    assert cut.counters == whole.counters


@properties(150)
@given(streams(), chunk_sizes())
def test_chunks_give_the_same_counters_where_gaps_are_long(stream, sizes):
    """A gap longer than the framer keeps is counted the same way."""
    whole, cut = Run([stream], max_gap=60), Run(chunks(stream, sizes), max_gap=60)
    assert cut.frames == whole.frames
    assert cut.counters == whole.counters


@pytest.mark.parametrize('size', [1, 2, 5, 28, 29, 1000, 10 ** 6])
def test_all_frames_of_a_long_unknown_sequence_are_counted(size):
    """A device of a later version sends only such frames."""
    stream = make_frame(4, 0x01, bytes(15)) * 200
    run = Run(chunks(stream, [size]))
    assert run.counters.unknown_types == {'0x01 of version 4': 200}
    assert run.counters.skipped_bytes == 0


# Counting

@properties(250)
@given(st.one_of(streams(), hostile_bytes(), st.binary(max_size=300)), chunk_sizes(),
       st.sampled_from((0, 1, 50, 1024)))
def test_every_byte_received_is_accounted_for_at_any_time(stream, sizes, gap):
    """Exactly once: as a frame, unknown, skipped or pending."""
    framer = Framer(BahrsFormat(), max_gap=gap)
    fed = 0
    for chunk in chunks(stream, sizes):
        framer.feed(chunk)
        fed += len(chunk)
        assert framer.received == fed == accounted(framer)
    framer.flush()
    assert framer.received == fed == accounted(framer)


@properties(100)
@given(st.lists(known_frames(), max_size=6), chunk_sizes())
def test_a_clean_stream_is_counted_only_as_frames(frames, sizes):
    """Nothing fails, is skipped or is pending."""
    run = Run(chunks(b''.join(frames), sizes), flush=False)
    counters = run.counters
    assert (counters.frames, counters.frame_bytes) == (len(frames), sum(map(len, frames)))
    assert (counters.crc_failures, counters.skipped_bytes, counters.unknown_bytes) == (0, 0, 0)
    assert (run.data, run.framer.pending) == (frames, 0)


def test_a_failed_checksum_is_counted_once():
    """Its bytes are skipped."""
    broken = FIRST_FRAME[:10] + b'\xAA' + FIRST_FRAME[11:]
    counters = Run([PULSE, broken, PULSE]).counters
    assert (counters.crc_failures, counters.skipped_bytes, counters.frames) == (1, 24, 2)


def test_a_failed_service_frame_is_counted_once():
    """Although two sizes and three checksums fail."""
    assert Run([b'NE\x03\x00\xF0' + bytes(20)]).counters.crc_failures == 1


def test_noise_is_skipped_without_a_failure():
    """Without a marker there is no candidate."""
    counters = Run([b'noise, no more', FIRST_FRAME]).counters
    assert (counters.crc_failures, counters.skipped_bytes) == (0, 14)


def test_bytes_that_can_be_in_no_frame_are_skipped_at_once():
    """They are not pending until the next frame."""
    run = Run([bytes(100)], flush=False)
    assert run.counters.skipped_bytes >= 99


# Unknown types

@properties(200)
@given(st.lists(st.tuples(known_frames(), st.lists(debug_frames(), max_size=3)), min_size=1,
                max_size=4), known_frames(), chunk_sizes())
def test_debug_frames_between_frames_are_counted_and_cost_nothing(parts, last, sizes):
    """By type, instead of skipped bytes."""
    debug = [frame for _, frames in parts for frame in frames]
    stream = b''.join(known + b''.join(frames) for known, frames in parts) + last
    run = Run(chunks(stream, sizes), flush=False)
    assert run.data == [known for known, _ in parts] + [last]
    assert run.counters.unknown_types == Counter(f'0x{frame[4]:02X}' for frame in debug)
    assert run.counters.unknown_bytes == sum(map(len, debug))
    assert (run.counters.skipped_bytes, run.counters.crc_failures) == (0, 0)


@pytest.mark.parametrize('debug, name', [(DEBUG_C0, '0xC0'), (DEBUG_C1, '0xC1')])
@pytest.mark.parametrize('order', ['auto', 'word'])
def test_a_literal_debug_frame_is_counted(debug, name, order):
    """Its layout is known, although the document does not have it."""
    run = Run([FIRST_FRAME, debug, FIRST_FRAME], order)
    assert run.counters.unknown_types == {name: 1}
    assert (run.counters.unknown_bytes, run.counters.skipped_bytes) == (len(debug), 0)


@pytest.mark.parametrize('message_type, size', [(0x01, 15), (0x02, 13), (0xF0, 0), (0x20, 40)])
def test_frames_of_an_unknown_version_are_counted_and_cost_nothing(message_type, size):
    """A newer device may be on the line."""
    later = make_frame(4, message_type, bytes(size))
    run = Run([FIRST_FRAME, later, later, PULSE])
    assert run.data == [FIRST_FRAME, PULSE]
    assert run.counters.unknown_types == {f'0x{message_type:02X} of version 4': 2}
    assert run.counters.skipped_bytes == 0


@pytest.mark.parametrize('size', [1, 3, 10 ** 6])
def test_unknown_frames_at_the_end_are_counted_by_flush(size):
    """The last one ends with the stream."""
    run = Run(chunks(FIRST_FRAME + DEBUG_C1 + DEBUG_C0, [size]))
    assert run.counters.unknown_types == {'0xC1': 1, '0xC0': 1}
    assert run.counters.skipped_bytes == 0


@pytest.mark.parametrize('tail', [b'NE', FIRST_FRAME[:4], FIRST_FRAME[:10]])
@pytest.mark.parametrize('size', [1, 10 ** 6])
def test_a_frame_cut_short_by_the_end_does_not_hide_the_unknown_one_before_it(tail, size):
    """A recording may end anywhere."""
    counters = Run(chunks(FIRST_FRAME + DEBUG_C1 + tail, [size])).counters
    assert (counters.unknown_types, counters.skipped_bytes) == ({'0xC1': 1}, len(tail))


def test_noise_before_an_unknown_frame_does_not_hide_it():
    """Only the noise is skipped."""
    counters = Run([FIRST_FRAME, b'noise' + DEBUG_C1, FIRST_FRAME]).counters
    assert (counters.unknown_types, counters.skipped_bytes) == ({'0xC1': 1}, 5)


def test_a_broken_unknown_frame_is_skipped():
    """It counts only if its checksum passes."""
    counters = Run([FIRST_FRAME, DEBUG_C1[:-1] + b'?', FIRST_FRAME]).counters
    assert (counters.unknown_types, counters.skipped_bytes) == ({}, 20)


@pytest.mark.parametrize('inside', [b'NE', b'NE\x02\x00\xC0', b'NE\x02\x00\x05'])
def test_a_marker_inside_an_unknown_frame_does_not_hide_it(inside):
    """Its payload may contain anything."""
    payload = b'\x01' + bytes(8) + b'\x10\x00' + inside + bytes(16 - len(inside))
    run = Run([FIRST_FRAME, make_frame(2, 0xC0, payload), FIRST_FRAME])
    assert run.data == [FIRST_FRAME, FIRST_FRAME]
    assert (run.counters.unknown_types, run.counters.skipped_bytes) == ({'0xC0': 1}, 0)


def test_a_broken_frame_after_an_unknown_one_does_not_hide_it():
    """The unknown frame may end at the rejected candidate."""
    broken = FIRST_FRAME[:10] + b'\xAA' + FIRST_FRAME[11:]
    counters = Run([FIRST_FRAME, DEBUG_C1, broken, FIRST_FRAME]).counters
    assert (counters.unknown_types, counters.skipped_bytes) == ({'0xC1': 1}, 24)


# Order of the checksum

@properties(100)
@given(st.lists(st.tuples(stream_frames(['word']) | stream_frames(['byte']), noise()),
                min_size=1, max_size=8))
def test_a_change_of_order_loses_nothing(parts):
    """Another device may be on the line."""
    assert Run([frame + after for frame, after in parts]).data == [frame for frame, _ in parts]


def test_the_order_seen_follows_the_stream():
    """It is the order of the latest frame."""
    frame_format = BahrsFormat()
    framer = Framer(frame_format)
    seen = []
    for order in ('word', 'byte', 'byte', 'word', 'byte'):
        framer.feed(make_frame(3, 0x01, bytes(15), order))
        seen.append(frame_format.order_seen)
    assert seen == ['word', 'byte', 'byte', 'word', 'byte']


@pytest.mark.parametrize('order', ['word', 'byte'])
def test_a_forced_order_rejects_the_other(order):
    """Frames of the forced order are found."""
    frames = {checksum: make_frame(2, 0x01, bytes(14), checksum) for checksum in ('word', 'byte')}
    run = Run([frames['byte'], frames['word'], frames['byte'], frames['word']], order)
    assert run.data == [frames[order]] * 2
    assert run.counters.crc_failures == 2
    assert {frame.checksum for frame in run.frames} == {order}


# Bounds

@properties(150)
@given(st.one_of(hostile_bytes(), streams()), chunk_sizes(), st.sampled_from((0, 64, 1024)))
def test_pending_bytes_are_bounded(stream, sizes, gap):
    """After any feed, for any noise."""
    framer = Framer(BahrsFormat(), max_gap=gap)
    for chunk in chunks(stream, sizes):
        framer.feed(chunk)
        assert framer.pending <= gap + LONGEST_FRAME + HEADER_SIZE


@pytest.mark.parametrize('unit', [
    b'NE', b'N', PAGE_HEADER, b'NE\x02\x00\xC0', b'NE\x03\x00\xF0', b'NE\x04\x00\x01' + bytes(40)])
@pytest.mark.parametrize('size', [1, 64, 10 ** 6])
def test_pending_bytes_of_endless_noise_are_bounded(unit, size):
    """The bound is the longest gap and one frame."""
    stream = unit * (20000 // len(unit))
    framer = Framer(BahrsFormat())
    for chunk in chunks(stream, [size]):
        framer.feed(chunk)
        assert framer.pending <= 1024 + LONGEST_FRAME + HEADER_SIZE


class Meter(BahrsFormat):
    """Counts the bytes over which checksums are computed, each attempt once."""

    work = 0

    def passing_checksum(self, frame, expected):
        """Count the bytes of a candidate."""
        self.work += len(frame)
        return super().passing_checksum(frame, expected)

    def name_unknown(self, frame):
        """Count the bytes of an unknown candidate."""
        self.work += len(frame)
        return super().name_unknown(frame)


@pytest.mark.parametrize('unit', [
    b'NE', b'N', PAGE_HEADER, b'NE\x02\x00\xC0', b'NE\x03\x00\xF0', DEBUG_C1, FIRST_FRAME])
@pytest.mark.parametrize('size', [1, 7, 10 ** 6])
def test_the_work_for_a_byte_is_bounded(unit, size):
    """The bound is the longest gap: a hostile stream must not stop the driver."""
    meter = Meter()
    framer = Framer(meter)
    for chunk in chunks(unit * (24000 // len(unit)), [size]):
        framer.feed(chunk)
    assert meter.work <= 1024 * 24000


@properties(250)
@given(st.one_of(st.binary(max_size=600), hostile_bytes(), streams()), chunk_sizes(),
       st.sampled_from(('auto', 'word', 'byte')))
@example(b'NE', [1], 'auto')
@example(b'NE\x03\x00\xF0', [5], 'word')
def test_no_bytes_raise(stream, sizes, order):
    """All frames found can be decoded."""
    codec = BahrsCodec()
    for frame in Run(chunks(stream, sizes), order).frames:
        assert codec.decode(frame).TYPE == frame.data[4]


# The end of a stream

def test_flush_returns_the_frames_inside_an_incomplete_candidate():
    """In stream order."""
    framer = Framer(BahrsFormat())
    assert framer.feed(PAGE_HEADER + PULSE + b'NE') == []
    assert [frame.data for frame in framer.flush()] == [PULSE]
    assert (framer.pending, framer.counters.skipped_bytes) == (0, 7)


def test_flush_returns_frames_after_several_incomplete_candidates():
    """Each of them contains the next."""
    framer = Framer(BahrsFormat())
    first = framer.feed(PAGE_HEADER + FIRST_FRAME[:6] + PULSE)
    assert [frame.data for frame in first + framer.flush()] == [PULSE]


@properties(100)
@given(streams(), st.integers(1, 23))
def test_flush_ends_the_stream(stream, cut):
    """The halves of a frame before and after it are not joined."""
    framer = Framer(BahrsFormat())
    framer.feed(stream + FIRST_FRAME[:cut])
    framer.flush()
    assert (framer.pending, framer.flush()) == (0, [])
    assert framer.feed(FIRST_FRAME[cut:]) + framer.flush() == []


@properties(100)
@given(streams())
def test_offsets_continue_after_a_flush(stream):
    """They count all bytes fed."""
    framer = Framer(BahrsFormat())
    framer.feed(stream)
    framer.flush()
    (frame,) = framer.feed(FIRST_FRAME)
    assert (frame.offset, frame.data) == (len(stream), FIRST_FRAME)


def test_a_flush_without_pending_bytes_changes_nothing():
    """Neither does another one."""
    run = Run([FIRST_FRAME])
    before = run.counters.frames, run.framer.received
    assert run.framer.flush() == []
    assert (run.counters.frames, run.framer.received) == before == (1, 24)


# Another format

class Tagged:
    """A format with a marker of four equal bytes, and its length in the fifth."""

    marker = b'AAAA'
    header_size = 5

    def sizes(self, header, expected):
        """Return the size that the header gives."""
        return (header[4] + 9,) if len(header) == 5 and header[4] < 40 else ()

    def passing_checksum(self, frame, expected):
        """Return the name of the only checksum."""
        return 'crc' if zlib.crc32(frame[:-4]).to_bytes(4, 'big') == frame[-4:] else None

    def name_unknown(self, frame):
        """Return None: all types are known."""
        return None


def tagged(payload):
    """Return a frame of the other format."""
    body = b'AAAA' + bytes([len(payload)]) + payload
    return body + zlib.crc32(body).to_bytes(4, 'big')


@properties(150)
@given(st.lists(st.tuples(st.text('AB', max_size=9), st.binary(max_size=12)), max_size=5),
       chunk_sizes())
def test_a_longer_marker_is_found_across_chunks(parts, sizes):
    """Even if noise begins like it."""
    frames = [tagged(payload) for _, payload in parts]
    stream = b''.join(lead.encode() + frame for (lead, _), frame in zip(parts, frames))
    framer = Framer(Tagged())
    found = [frame for chunk in chunks(stream, sizes) for frame in framer.feed(chunk)]
    assert [frame.data for frame in found + framer.flush()] == frames
    assert accounted(framer) == framer.received == len(stream)


# The recording

def test_the_recording_is_framed_without_a_failure(recording):
    """All frames of a real device, in word order, version 2."""
    frame_format = BahrsFormat()
    framer = Framer(frame_format)
    frames = [frame for chunk in chunks(recording, [4096]) for frame in framer.feed(chunk)]
    counters = framer.counters
    assert Counter(frame.data[4] for frame in frames) == {
        0x01: 47837, 0x02: 23919, 0x03: 2392, 0x04: 2392, 0x05: 2392}
    assert (counters.frames, counters.frame_bytes) == (78932, 1884800)
    assert (counters.crc_failures, counters.skipped_bytes, counters.unknown_bytes) == (0, 0, 0)
    assert (framer.pending, framer.flush()) == (0, [])
    assert (frame_format.order_seen, frame_format.version_seen) == ('word', 2)
    assert {frame.checksum for frame in frames} == {'word'}


def test_the_recording_has_no_frame_in_byte_order(recording):
    """The two orders are never confused."""
    run = Run([recording[:100000]], 'byte')
    assert (run.frames, run.counters.frames) == ([], 0)


@pytest.mark.parametrize('start', [1, 5, 23])
def test_a_start_inside_a_frame_loses_only_that_frame(recording, start):
    """A driver may start at any time."""
    run = Run(chunks(recording[start:20000], [17]), flush=False)
    assert run.frames[0].offset == 24 - start
    assert run.counters.skipped_bytes == 24 - start
