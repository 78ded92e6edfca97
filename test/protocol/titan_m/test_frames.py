# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the Titan-M's messages and frames: independent vectors, both ways; any stream."""

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
    """Return a field as the vectors have it."""
    return list(value) if isinstance(value, tuple) else value


def test_requests_are_those_of_the_document():
    """Byte for byte."""
    assert build_request(StateRequest).hex(' ') == '33 47 53 54 02 00 01 23'
    assert build_request(GpsRequest).hex(' ') == '33 47 47 50 02 00 01 13'
    assert build_request(SensorsRequest).hex(' ') == '33 47 53 45 02 00 01 14'


def test_all_vectors_of_requests():
    """Both orders of the checksum, found and made."""
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
def test_all_vectors_of_answers(size):
    """Both orders of checksum and payload, both LEN, all fields; whole and byte by byte."""
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


def test_all_vectors_of_one_checksum_order_in_one_stream():
    """With noise between them, and bytes behind them."""
    for order in ORDERS:
        data = [bytes.fromhex(vector['hex']) for vector in vectors()
                if vector['checksum_order'] == order and 'request' not in vector['message']]
        frames, framer = frames_in(b'\x31A'.join([b'', *data, b'1AC']))
        assert [frame.data for frame in frames] == data
        assert framer.counters.skipped_bytes == 2 * len(data) + 5


messages = st.sampled_from([STATE, GPS, SENSORS])
frames = st.builds(build_answer, messages, st.integers(0, 255),
                   st.sampled_from(['little', 'big']))
# Noise that no frame can begin in.
noise = st.binary(max_size=20).map(lambda data: data.replace(b'1', b'0'))


@given(st.lists(st.tuples(noise, frames), max_size=8), st.lists(st.integers(1, 90), max_size=9))
def test_every_intact_frame_is_found_however_the_stream_is_cut(parts, cuts):
    """Whatever comes in between."""
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
def test_any_bytes_are_taken(data):
    """Nothing raises, and no byte is lost count of."""
    _, framer = frames_in(data)
    assert framer.counters.frame_bytes + framer.counters.skipped_bytes == len(data)


@given(messages, st.integers(0, 51), st.integers(0, 7))
def test_one_wrong_bit_costs_one_frame(message, place, bit):
    """The next is found behind it, whatever the damaged one says of its length."""
    damaged = bytearray(build_answer(message))
    damaged[place] ^= 1 << bit
    good = build_answer(STATE, 7)
    found, _ = frames_in(bytes(damaged) + good + good)
    assert [frame.data for frame in found] == [good, good]


def test_no_answer_is_taken_for_another_of_the_same_length():
    """A sensor answer whose first 44 bytes look like a GPS answer, checksum and all."""
    body = bytearray(build_answer(SENSORS, length=0x2E))
    body[50:52] = (sum(body[:50]) & 0xFFFF).to_bytes(2, 'big')
    data = bytes(body[:-2]) + (sum(body[:-2]) & 0xFFFF).to_bytes(2, 'big')
    (frame,) = Framer(AnswerFormat()).feed(data + build_answer(STATE)[:9], [Sensors, State])
    assert frame.data == data
    # A recording tells nothing of requests: but the zone would be 192, the hemisphere 241.
    assert data[46] > 60
    (frame,), _ = frames_in(data)
    assert frame.data == data


def test_a_device_with_the_right_length_leaves_the_other_to_gps():
    """Then any zone is good."""
    nowhere = build_answer(Gps(*[0.0] * 4, (0.0,) * 3, *[0.0] * 3, 99, True))
    found, framer = frames_in(build_answer(SENSORS) + nowhere)
    assert [answer_of(frame).kind for frame in found] == [Sensors, Gps]


def test_one_order_of_checksums_is_enough():
    """After a few frames in a row the other is no more taken; the same bytes twice tell none."""
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
    # Nothing but the other one, and it is another device.
    assert not framer.feed(little * (ENOUGH - 1))
    assert len(framer.feed(little * 9)) == 9 and frame_format.checksum_order.seen == 'little'
    frame_format.reset()
    assert len(framer.feed(little)) == 1
    forced = Framer(AnswerFormat('little'))
    assert not forced.feed(big * 20) and len(forced.feed(little + little)) == 2


def test_a_value_that_does_not_fit_is_told():
    """By field and unit."""
    with pytest.raises(ValueError, match='northing: 1000000000.0 m does not fit its field'):
        build_answer(Gps(0.0, 0.0, 1e9, 0.0, (0.0,) * 3, 0.0, 0.0, 0.0, 1, True))


def test_names_and_commands():
    """Every answer has a request."""
    assert {kind.ANSWER.NAME + '_request' for kind in REQUESTS} == {
        kind.NAME for kind in REQUESTS}
