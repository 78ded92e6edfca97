# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of Titan-M messages and frames: vectors in both directions, and any stream."""

import json

from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.titan_m.frames import (
    answer_of, AnswerFormat, build_answer, build_request, ENOUGH, message_id, request_of,
    RequestFormat,
)
from bahrs_driver.protocol.titan_m.messages import (
    Gps, GpsRequest, LAYOUTS, REQUESTS, Sensors, SensorsRequest, State, StateRequest,
)
from hypothesis import given, strategies as st
import pytest
from support.shared_files import shared_file
from support.titan_m_frames import frames_in, GPS, SENSORS, STATE

ORDERS = {'<': 'little', '>': 'big'}


def vectors():
    """Return the vectors of the Titan-M."""
    path = shared_file('vectors/frames.json')
    return [vector for vector in json.loads(path.read_text()) if vector['device'] == 'titan_m']


def plain(value):
    """Return a field as the vectors write it."""
    return list(value) if isinstance(value, tuple) else value


def test_requests_equal_those_of_the_document():
    """Byte for byte."""
    assert build_request(StateRequest).hex(' ') == '33 47 53 54 02 00 01 23'
    assert build_request(GpsRequest).hex(' ') == '33 47 47 50 02 00 01 13'
    assert build_request(SensorsRequest).hex(' ') == '33 47 53 45 02 00 01 14'


def test_request_vectors_in_both_directions():
    """With both orders of the checksum."""
    seen = 0
    for vector in vectors():
        if vector['message'].endswith('_request'):
            data, order = bytes.fromhex(vector['hex']), ORDERS[vector['checksum_order']]
            (frame,), _ = frames_in(data, RequestFormat())
            kind = request_of(frame)
            assert (kind.NAME, frame.checksum) == (vector['message'], order)
            assert build_request(kind, message_id(frame), order) == data
            seen += 1
    assert seen == 6


@pytest.mark.parametrize('size', [None, 1])
def test_answer_vectors_in_both_directions(size):
    """With both orders of checksum and payload, both LEN, whole and byte by byte."""
    seen = set()
    for vector in vectors():
        if vector['message'].endswith('_request'):
            continue
        data = bytes.fromhex(vector['hex'])
        checksum, payload = ORDERS[vector['checksum_order']], ORDERS[vector['payload_order']]
        (frame,), framer = frames_in(data, size=size)
        answer = answer_of(frame)
        assert (answer.NAME, frame.checksum) == (vector['message'], checksum)
        message = LAYOUTS[answer.kind, payload].decode(answer.payload)
        assert {name: plain(getattr(message, name)) for name in vector['si']} == {
            name: pytest.approx(value, rel=1e-12, abs=1e-12)
            for name, value in vector['si'].items()}
        assert build_answer(message, answer.message_id, payload, checksum, data[4]) == data
        seen.add((answer.NAME, checksum, payload, data[4]))
    assert len(seen) == 16


def test_vectors_of_one_checksum_order_are_found_in_one_stream():
    """With noise between them, and bytes after them."""
    for order in ORDERS:
        data = [bytes.fromhex(vector['hex']) for vector in vectors()
                if vector['checksum_order'] == order and 'request' not in vector['message']]
        frames, framer = frames_in(b'\x31A'.join([b'', *data, b'1AC']))
        assert [frame.data for frame in frames] == data
        assert framer.counters.skipped_bytes == 2 * len(data) + 5


messages = st.sampled_from([STATE, GPS, SENSORS])
frames = st.builds(build_answer, messages, st.integers(0, 255),
                   st.sampled_from(['little', 'big']))
# Noise without the first byte of a marker.
noise = st.binary(max_size=20).map(lambda data: data.replace(b'1', b'0'))


@given(st.lists(st.tuples(noise, frames), max_size=8), st.lists(st.integers(1, 90), max_size=9))
def test_every_intact_frame_is_found_however_the_stream_is_cut(parts, cuts):
    """Whatever is between them."""
    stream = b''.join(rubbish + frame for rubbish, frame in parts)
    framer, found, start = Framer(AnswerFormat()), [], 0
    for cut in [*cuts, len(stream)]:
        found += framer.feed(stream[start:start + cut])
        start += cut
    found += framer.feed(stream[start:]) + framer.flush()
    assert [frame.data for frame in found] == [frame for _, frame in parts]
    counters = framer.counters
    assert counters.frame_bytes + counters.skipped_bytes == len(stream)


@given(st.binary(max_size=400))
def test_no_bytes_raise_and_all_are_counted(data):
    """As frames or skipped bytes."""
    _, framer = frames_in(data)
    assert framer.counters.frame_bytes + framer.counters.skipped_bytes == len(data)


@given(messages, st.integers(0, 51), st.integers(0, 7))
def test_one_wrong_bit_costs_one_frame(message, place, bit):
    """The next one is found, whatever the length in the damaged one is."""
    damaged = bytearray(build_answer(message))
    damaged[place] ^= 1 << bit
    good = build_answer(STATE, 7)
    found, _ = frames_in(bytes(damaged) + good + good)
    assert [frame.data for frame in found] == [good, good]


def test_answers_with_the_same_len_are_distinguished():
    """A sensor answer may contain a GPS answer with a correct checksum."""
    body = bytearray(build_answer(SENSORS, length=0x2E))
    body[50:52] = (sum(body[:50]) & 0xFFFF).to_bytes(2, 'big')
    data = bytes(body[:-2]) + (sum(body[:-2]) & 0xFFFF).to_bytes(2, 'big')
    (frame,) = Framer(AnswerFormat()).feed(data + build_answer(STATE)[:9], [Sensors, State])
    assert frame.data == data
    # The requests of a recording are unknown, but the zone would be 192, the hemisphere 241.
    assert data[46] > 60
    (frame,), _ = frames_in(data)
    assert frame.data == data


def test_len_0x2e_is_a_gps_answer_if_the_device_uses_0x3a():
    """Even if its zone is invalid."""
    nowhere = build_answer(Gps(*[0.0] * 4, (0.0,) * 3, *[0.0] * 3, 99, True))
    found, framer = frames_in(build_answer(SENSORS) + nowhere)
    assert [answer_of(frame).kind for frame in found] == [Sensors, Gps]


def test_the_order_of_checksums_is_locked():
    """After a few consecutive frames; a checksum of two equal bytes does not show its order."""
    frame_format = AnswerFormat()
    little = build_answer(STATE, checksum_order='little')
    big = build_answer(STATE, checksum_order='big')
    assert little != big
    framer = Framer(frame_format)
    assert len(framer.feed(big * 2 + little + big * (ENOUGH - 1))) == ENOUGH + 2
    assert not frame_format.checksum_order.locked
    assert len(framer.feed(big + little)) == 1 and frame_format.checksum_order.locked
    assert not framer.feed(little * (ENOUGH - 2))
    assert len(framer.feed(big)) == 1
    # Another device is on the line if only the other order arrives.
    assert not framer.feed(little * (ENOUGH - 1))
    assert len(framer.feed(little * 9)) == 9 and frame_format.checksum_order.seen == 'little'
    frame_format.reset()
    assert len(framer.feed(little)) == 1
    forced = Framer(AnswerFormat('little'))
    assert not forced.feed(big * 20) and len(forced.feed(little + little)) == 2


def test_the_error_of_a_value_that_does_not_fit_names_field_and_unit():
    """When an answer is encoded."""
    with pytest.raises(ValueError, match='northing: 1000000000.0 m does not fit its field'):
        build_answer(Gps(0.0, 0.0, 1e9, 0.0, (0.0,) * 3, 0.0, 0.0, 0.0, 1, True))


def test_names_and_commands():
    """Every answer has its request."""
    assert {kind.ANSWER.NAME + '_request' for kind in REQUESTS} == {
        kind.NAME for kind in REQUESTS}
