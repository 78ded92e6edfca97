# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the decoder of answers, in a pipeline."""

from bahrs_driver.clock import ExchangeClock, Instant
from bahrs_driver.pipeline import Pipeline
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.decoder import TitanDecoder
from bahrs_driver.protocol.titan_m.frames import Answer, AnswerFormat, build_answer, REQUEST_SIZE
from bahrs_driver.protocol.titan_m.messages import Sensors, State, StateRequest
from bahrs_driver.protocol.titan_m.poller import Poller
from support.titan_m_frames import SENSORS, STATE

MS = 1_000_000
ROS = 1_700_000_000_000_000_000
ZEROS = State(*[(0.0,) * 3] * 4)


def polled():
    """Return an open pipeline that is polled for states, and its poller."""
    frame_format = AnswerFormat()
    poller = Poller({StateRequest: 50.0}, frame_format)
    pipeline = Pipeline(Framer(frame_format), TitanDecoder(PayloadDecoder(), poller),
                        ExchangeClock(REQUEST_SIZE))
    pipeline.open(0)
    return pipeline, poller


def exchange(pipeline, poller, message, now):
    """Request a state and feed the answer 4 ms later; return the messages with their stamps."""
    assert poller.send(now)
    events = pipeline.feed(build_answer(message, payload_order='big'),
                           Instant(now + 4 * MS, ROS + now + 4 * MS))
    return [(event.message, event.stamp_ns - ROS) for event in events]


def test_held_answers_keep_the_stamps_of_their_exchanges():
    """The middle of request and answer, although the byte order is known only later."""
    pipeline, poller = polled()
    (held, stamp), = exchange(pipeline, poller, ZEROS, 0)
    assert isinstance(held, Answer) and (held.NAME, stamp) == ('state', 2 * MS)
    assert exchange(pipeline, poller, STATE, 20 * MS) == [(ZEROS, 2 * MS), (STATE, 22 * MS)]
    assert exchange(pipeline, poller, STATE, 40 * MS) == [(STATE, 42 * MS)]


def test_an_unexpected_answer_stays_undecoded():
    """Its time is not known."""
    pipeline, poller = polled()
    exchange(pipeline, poller, STATE, 0)
    event, = pipeline.feed(build_answer(STATE), Instant(9 * MS, ROS + 9 * MS))
    assert isinstance(event.message, Answer) and event.message.NAME == 'unexpected'
    assert poller.unexpected == {StateRequest: 1}


def test_opening_and_closing_a_stream_starts_and_stops_polling():
    """The byte order is forgotten: another device may be on the line."""
    pipeline, poller = polled()
    assert exchange(pipeline, poller, STATE, 0) == [(STATE, 2 * MS)]
    pipeline.close()
    assert poller.due(10 ** 12) is None
    pipeline.open(0)
    (held, _), = exchange(pipeline, poller, ZEROS, 10 ** 12)
    assert isinstance(held, Answer)


def test_without_a_poller_every_answer_is_decoded():
    """Another host polls the device, or the stream is a recording."""
    decoder = TitanDecoder(PayloadDecoder('little'))
    pipeline = Pipeline(Framer(AnswerFormat()), decoder, ExchangeClock(REQUEST_SIZE))
    pipeline.open(0)
    assert decoder.expected() is None
    events = pipeline.feed(build_answer(STATE) + build_answer(SENSORS, length=0x2E),
                           Instant(MS, ROS))
    assert [type(event.message) for event in events] == [State, Sensors]
    assert events[0].message == STATE
