# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of polling, with literal times."""

import heapq
import random

from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.protocol.titan_m.frames import (
    answer_of, AnswerFormat, build_answer, message_id, request_of, RequestFormat,
)
from bahrs_driver.protocol.titan_m.messages import (
    Gps, GpsRequest, Sensors, SensorsRequest, State, StateRequest,
)
from bahrs_driver.protocol.titan_m.poller import ID_VOTES, MARGIN, Poller, PollOptions, UNANSWERED
from hypothesis import given, strategies as st
import pytest
from support.titan_m_frames import GPS, SENSORS, STATE

MS = 1_000_000
BYTE = 86_805               # ns at 115200 baud
ALL = {SensorsRequest: 50.0, StateRequest: 50.0, GpsRequest: 10.0}
TIMEOUT = 200 * MS
OF = {State: STATE, Gps: GPS, Sensors: SENSORS}


def begun(rates, byte_time=BYTE, **options):
    """Return a poller on an open line."""
    poller = Poller(rates, AnswerFormat(), PollOptions(**options))
    poller.start(byte_time)
    return poller


def asked(data):
    """Return kind and id of a request."""
    frame, = Framer(RequestFormat()).feed(data)
    return request_of(frame), message_id(frame)


def answer(poller, kind, now, identity=0):
    """Match an answer; return the time of its request, None if it is unexpected."""
    taken = poller.match(answer_of(Frame(0, build_answer(OF[kind], identity), 'big')), now)
    assert taken.expected == (taken.NAME == kind.NAME)
    return taken.requested_at if taken.expected else None


def test_nothing_is_sent_on_a_closed_line():
    """Neither before it is opened nor after it is lost."""
    poller = Poller(ALL, AnswerFormat())
    assert poller.due(0) is None and poller.send(0) == b''
    poller.start(BYTE)
    assert poller.due(0) == 0 and poller.send(0)
    poller.stop()
    assert poller.due(10 ** 12) is None and poller.send(10 ** 12) == b''
    assert poller.unanswered.total() == 0


def test_requests_are_sent_one_after_another():
    """The next one after an answer, and each kind at its own rate."""
    poller = begun(ALL)
    assert asked(poller.send(0)) == (SensorsRequest, 0)
    assert poller.send(1 * MS) == b'' and poller.expected() == [Sensors]
    assert answer(poller, Sensors, 7 * MS) == 0
    assert poller.due(7 * MS) == 7 * MS
    assert asked(poller.send(7 * MS)) == (StateRequest, 0)
    assert answer(poller, State, 13 * MS) == 7 * MS
    assert asked(poller.send(13 * MS)) == (GpsRequest, 0)
    assert answer(poller, Gps, 19 * MS) == 13 * MS
    assert poller.due(19 * MS) == 20 * MS and poller.send(19 * MS) == b''
    assert asked(poller.send(20 * MS)) == (SensorsRequest, 0)
    assert poller.answered.total() == 3 and poller.unanswered.total() == 0


def test_an_answer_of_another_kind_is_unexpected():
    """It is counted, and the request stays outstanding."""
    poller = begun({StateRequest: 50.0})
    poller.send(0)
    assert answer(poller, Sensors, 6 * MS) is None
    assert answer(poller, State, 7 * MS) == 0
    assert answer(poller, State, 8 * MS) is None        # the second one
    assert dict(poller.unexpected) == {SensorsRequest: 1, StateRequest: 1}
    assert poller.answered == {StateRequest: 1}


def test_an_unanswered_request_is_repeated_and_then_lost():
    """Each attempt counts as unanswered, and the turn as lost."""
    poller = begun({StateRequest: 1.0}, retries=1)
    poller.send(0)
    deadline = poller.due(0)
    assert deadline == (8 + 56) * BYTE + TIMEOUT
    assert poller.send(deadline - 1) == b''
    assert asked(poller.send(deadline)) == (StateRequest, 0)
    assert (poller.unanswered[StateRequest], poller.lost[StateRequest]) == (1, 0)
    second = poller.due(deadline)
    assert poller.send(second) == b''
    assert (poller.unanswered[StateRequest], poller.lost[StateRequest]) == (2, 1)
    assert poller.due(second) == 1000 * MS
    assert poller.lost_by_name == {'state': 1, 'gps': 0, 'sensors': 0}


def test_the_time_out_is_adaptive():
    """It is twice the slowest of the latest answers, and a margin."""
    poller = begun({StateRequest: 50.0})
    for turn in range(4):
        now = 20 * MS * turn
        poller.send(now)
        answer(poller, State, now + 64 * BYTE + 3 * MS)
    assert poller.slowest == 3 * MS
    poller.send(80 * MS)
    assert poller.due(80 * MS) == 80 * MS + 64 * BYTE + MARGIN + 6 * MS


def test_a_late_answer_raises_the_time_out():
    """Although it is unexpected."""
    poller = begun({StateRequest: 1.0}, timeout=50 * MS, retries=0)
    for turn in range(4):
        poller.send(1000 * MS * turn)
        answer(poller, State, 1000 * MS * turn + 64 * BYTE)
    poller.send(4000 * MS)
    late = poller.due(4000 * MS)
    assert poller.send(late) == b''
    assert answer(poller, State, late + 5 * MS) is None
    poller.send(5000 * MS)
    assert poller.due(5000 * MS) == 5000 * MS + 64 * BYTE + 50 * MS     # the upper bound


def after_time_out(delay):
    """Return a poller whose answers took a time, with a repeated request, and its time."""
    poller = begun({StateRequest: 1.0}, timeout=50 * MS)
    for turn in range(4):
        poller.send(1000 * MS * turn)
        answer(poller, State, 1000 * MS * turn + delay)
    poller.send(4000 * MS)
    again = poller.due(4000 * MS)
    assert asked(poller.send(again)) == (StateRequest, 0)
    return poller, again


def test_a_late_answer_is_not_matched_with_the_repeated_request():
    """The line cannot have carried it since; the real one follows."""
    poller, again = after_time_out(64 * BYTE + MS)
    assert answer(poller, State, again + 2 * MS) is None
    assert poller.expected() == [State] and poller.unexpected == {StateRequest: 1}
    assert answer(poller, State, again + 64 * BYTE + MS) == again


def test_a_line_faster_than_its_nominal_rate_is_accepted():
    """An immediate answer may belong to the latest request."""
    poller, again = after_time_out(2 * MS)
    assert answer(poller, State, again + 2 * MS) == again


def test_the_other_byte_order_is_tried_without_answers():
    """It is kept when an answer arrives."""
    poller = begun({StateRequest: 10.0}, retries=0, timeout=20 * MS)
    frames = []
    now = 0
    while len(frames) < 2 * UNANSWERED:
        data = poller.send(now)
        if data:
            frames.append(data)
        now = poller.due(now)
    big, little = frames[0], frames[-1]
    assert big.hex() == '3347535402000123' and little.hex() == '3347535402002301'
    assert frames == [big] * UNANSWERED + [little] * UNANSWERED


def test_a_forced_byte_order_is_kept():
    """However long there are no answers."""
    poller = begun({StateRequest: 10.0}, retries=0, timeout=20 * MS, checksum_order='little')
    now = 0
    for _ in range(40):
        data = poller.send(now)
        assert data in (b'', bytes.fromhex('3347535402002301'))
        now = poller.due(now)


def test_pipelined_one_request_of_each_kind_is_outstanding():
    """If their answers differ in length."""
    frame_format = AnswerFormat()
    poller = Poller(ALL, frame_format, PollOptions(pipelined=True))
    poller.start(BYTE)
    assert [asked(poller.send(0))[0] for _ in range(2)] == [SensorsRequest, StateRequest]
    assert poller.send(0) == b''        # its answer could be confused with that of the sensors
    assert answer(poller, Sensors, 8 * MS) == 0
    assert asked(poller.send(8 * MS))[0] is GpsRequest
    poller.start(BYTE)
    Framer(frame_format).feed(build_answer(SENSORS))      # of 0x3A
    assert [asked(poller.send(0))[0] for _ in range(3)] == [
        SensorsRequest, StateRequest, GpsRequest]


def test_pipelined_requests_do_not_exceed_the_line():
    """At 9600 baud an answer takes 58 ms."""
    byte_time = 10 ** 10 // 9600
    poller = begun({StateRequest: 1000.0, SensorsRequest: 1000.0}, byte_time, pipelined=True)
    sizes, now = {State: 56, Sensors: 64}, 0
    poller.send(0)
    while now < 10 ** 10:
        kind = (poller.expected() or [State])[0]
        now += sizes[kind] * byte_time
        answer(poller, kind, now)
        while poller.send(now):
            pass
        assert len(poller.expected()) <= 2
    carried = sum(count * sizes[kind.ANSWER] for kind, count in poller.requests.items())
    assert carried * byte_time <= now + 3 * 64 * byte_time
    assert min(poller.answered.values()) > 60           # both kinds have turns
    assert poller.skipped > 1000


def test_returned_ids_distinguish_late_answers():
    """An answer to a request that timed out is unexpected, although its kind is outstanding."""
    poller = begun({StateRequest: 10.0}, counted_ids=True, retries=0)
    now = 0
    for turn in range(ID_VOTES):
        now = 100 * MS * turn
        _, identity = asked(poller.send(now))
        assert identity == turn
        assert answer(poller, State, now + 6 * MS, identity) == now
    assert poller.returns_ids
    _, lost = asked(poller.send(now + 100 * MS))
    assert poller.send(now + 199 * MS) == b''
    _, identity = asked(poller.send(now + 200 * MS))
    assert answer(poller, State, now + 201 * MS, lost) is None
    assert answer(poller, State, now + 207 * MS, identity) == now + 200 * MS


def test_ids_that_are_not_returned_are_ignored():
    """A device may always return 0."""
    poller = begun({StateRequest: 10.0}, counted_ids=True)
    for turn in range(300):
        now = 100 * MS * turn
        assert asked(poller.send(now))[1] == turn % 256
        assert answer(poller, State, now + 6 * MS, 0) == now
    assert not poller.returns_ids


@pytest.mark.parametrize('kind', [State, Gps, Sensors])
def test_an_answer_has_name_id_and_payload(kind):
    """Without a poller."""
    data = build_answer(OF[kind], 7)
    plain = answer_of(Frame(0, data, 'big'))
    assert (plain.NAME, plain.message_id, plain.payload) == (kind.NAME, 7, data[6:-2])


@given(st.booleans(), st.booleans(), st.integers(0, 2), st.integers(0, 10 ** 6),
       st.floats(0, 0.5), st.floats(0, 0.2))
def test_the_counters_are_consistent_on_any_line(pipelined, counted, retries, seed, lost, twice):
    """Answers are late, lost and doubled; nothing hangs, and each request is counted once."""
    chance = random.Random(seed)
    poller = begun(ALL, pipelined=pipelined, counted_ids=counted, retries=retries)
    now, coming, steps = 0, [], 0
    while now < 3000 * MS:
        steps += 1
        assert steps < 5000
        data = poller.send(now)
        if data:
            kind, identity = asked(data)
            for _ in range((chance.random() >= lost) + (chance.random() < twice)):
                heapq.heappush(coming, (now + chance.randrange(5 * MS, 300 * MS),
                                        kind.NAME, kind.ANSWER, identity))
        expected = poller.expected()
        assert len(expected) == len(set(expected)) <= (3 if pipelined else 1)
        under_way = len(expected)
        assert poller.requests.total() == (
            poller.answered.total() + poller.unanswered.total() + under_way)
        due = poller.due(now)
        assert due is not None
        if coming and coming[0][0] <= due:
            now, _, kind, identity = heapq.heappop(coming)
            before = poller.expected()
            assert answer(poller, kind, now, identity) is None or kind in before
        else:
            now = max(now, due)
    assert poller.requests.total() > 10
