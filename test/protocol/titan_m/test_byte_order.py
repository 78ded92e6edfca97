# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of detecting the byte order of payloads, and of holding answers until it is known."""

from dataclasses import replace
import json

from bahrs_driver.clock import Stamped
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.titan_m.byte_order import ENOUGH, little_endian_lead, PayloadDecoder
from bahrs_driver.protocol.titan_m.frames import Answer, answer_of, AnswerFormat
from bahrs_driver.protocol.titan_m.messages import Gps, LAYOUTS, State
from hypothesis import given, strategies as st
import pytest
from support.shared_files import shared_file
from support.titan_m_frames import frames_in, GPS, SENSORS, STATE

ORDERS = ('little', 'big')
ZEROS = {State: State(*[(0.0,) * 3] * 4),
         Gps: Gps(0.0, 0.0, 0.0, 0.0, (0.0,) * 3, 0.0, 0.0, 0.0, 0, True)}
FRAME = Frame(0, b'', 'big')


def answer(message, order):
    """Return the answer that contains a message in a byte order."""
    return Answer(type(message), 0, LAYOUTS[type(message), order].encode(message))


def resolve(payloads, message, order, stamp=0):
    """Resolve a message in a byte order; return the messages delivered, with their stamps."""
    items = payloads.resolve(Stamped(answer(message, order), FRAME, stamp))
    return [(item.message, item.stamp_ns) for item in items]


def test_every_vector_shows_its_order():
    """Each answer alone is enough."""
    for vector in json.loads(shared_file('vectors/frames.json').read_text()):
        if vector['device'] == 'titan_m' and 'request' not in vector['message']:
            (frame,), _ = frames_in(bytes.fromhex(vector['hex']), AnswerFormat())
            lead = little_endian_lead(answer_of(frame))
            assert lead >= ENOUGH if vector['payload_order'] == '<' else lead <= -ENOUGH


@pytest.mark.parametrize('order', ORDERS)
def test_answers_are_held_until_the_order_is_known(order):
    """They are delivered undecoded when they arrive, and as values later, with their stamps."""
    payloads = PayloadDecoder()
    assert resolve(payloads, ZEROS[State], order, 1) == [(answer(ZEROS[State], order), 1)]
    assert resolve(payloads, ZEROS[Gps], order, 2) == [(answer(ZEROS[Gps], order), 2)]
    assert (payloads.order, payloads.held, payloads.released) == (None, 2, 0)
    assert resolve(payloads, STATE, order, 3) == [
        (ZEROS[State], 1), (ZEROS[Gps], 2), (STATE, 3)]
    assert (payloads.order, payloads.held, payloads.released) == (order, 0, 2)
    assert resolve(payloads, ZEROS[State], order, 4) == [(ZEROS[State], 4)]
    assert payloads.released == 2


def test_a_known_order_is_kept_and_a_contradiction_reported():
    """An answer that is plausible in the other order only is decoded in the known order."""
    payloads = PayloadDecoder()
    resolve(payloads, STATE, 'little')
    (message, _), = resolve(payloads, STATE, 'big')
    assert message != STATE and payloads.order == 'little' and payloads.contradicted
    resolve(payloads, STATE, 'little')
    assert not payloads.contradicted
    payloads.reset()
    assert resolve(payloads, STATE, 'big', 3) == [(STATE, 3)]


def test_a_forced_order_holds_nothing():
    """Answers that contradict it are decoded in it."""
    payloads = PayloadDecoder('big')
    assert resolve(payloads, ZEROS[State], 'big') == [(ZEROS[State], 0)]
    (message, _), = resolve(payloads, STATE, 'little')
    assert message != STATE and payloads.contradicted


def test_unexpected_answers_are_neither_decoded_nor_counted_as_votes():
    """They pass unchanged, and so do messages that are not answers."""
    payloads = PayloadDecoder()
    unexpected = Stamped(replace(answer(STATE, 'little'), expected=False), FRAME, 5)
    assert payloads.resolve(unexpected) == [unexpected]
    assert payloads.order is None and payloads.held == 0
    value = Stamped(STATE, FRAME, 6)
    assert payloads.resolve(value) == [value]


def test_a_single_implausible_number_does_not_decide():
    """1e-12 m/s is implausible in both orders."""
    odd = State((0.0,) * 3, (1e-12, 0.0, 0.0), (0.0,) * 3, (0.0,) * 3)
    payloads = PayloadDecoder()
    resolve(payloads, odd, 'little')
    assert payloads.order is None and payloads.held == 1


def test_the_number_of_held_answers_is_limited():
    """The oldest are dropped and counted."""
    payloads = PayloadDecoder(max_held=3)
    for stamp in range(5):
        resolve(payloads, ZEROS[State], 'little', stamp)
    assert (payloads.held, payloads.dropped) == (3, 2)
    assert [stamp for _, stamp in resolve(payloads, GPS, 'big', 9)] == [3, 4, 9]
    assert payloads.order == 'big' and payloads.released == 2


def either_sign(least, most):
    """Return a strategy for numbers that are neither tiny nor large."""
    return st.one_of(st.floats(least, most, width=32), st.floats(-most, -least, width=32))


triples = st.tuples(*[either_sign(2 ** -10, 50)] * 3)
angles = st.tuples(*[either_sign(2 ** -10, 3)] * 3)


@given(st.lists(st.builds(State, triples, triples, angles, triples), min_size=4, max_size=4),
       st.sampled_from(ORDERS))
def test_ordinary_states_never_show_the_wrong_order(states, order):
    """A few of them may leave it unknown."""
    payloads = PayloadDecoder()
    for state in states:
        resolve(payloads, state, order)
    assert payloads.order in (order, None)


def test_sensor_answers_show_the_order():
    """Three calibrated numbers, the pressure and the temperature vote."""
    payloads = PayloadDecoder()
    for _ in range(3):
        resolve(payloads, SENSORS, 'big')
    assert payloads.order == 'big'
