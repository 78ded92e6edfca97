# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of telling the byte order of payloads, and of holding answers until it is known."""

import json

from bahrs_driver.protocol.titan_m.byte_order import ENOUGH, lead, PayloadReader
from bahrs_driver.protocol.titan_m.frames import answer_of, AnswerFormat
from bahrs_driver.protocol.titan_m.messages import Gps, LAYOUTS, State
from hypothesis import given, strategies as st
import pytest
from support.shared_files import shared_file
from support.titan_m_frames import frames_in, GPS, SENSORS, STATE

ORDERS = ('little', 'big')
NOTHING = {State: State(*[(0.0,) * 3] * 4),
           Gps: Gps(0.0, 0.0, 0.0, 0.0, (0.0,) * 3, 0.0, 0.0, 0.0, 0, True)}


def payload(message, order):
    """Return kind and payload of a message."""
    return type(message), LAYOUTS[type(message), order].encode(message)


def test_every_vector_tells_its_order():
    """Alone."""
    for vector in json.loads(shared_file('vectors/frames.json').read_text()):
        if vector['device'] == 'titan_m' and 'request' not in vector['message']:
            (frame,), _ = frames_in(bytes.fromhex(vector['hex']), AnswerFormat())
            votes = lead(answer_of(frame).kind, answer_of(frame).payload)
            assert votes >= ENOUGH if vector['payload_order'] == '<' else votes <= -ENOUGH


@pytest.mark.parametrize('order', ORDERS)
def test_what_tells_nothing_is_held_until_something_tells(order):
    """And comes then, in order, each with its tag."""
    reader = PayloadReader()
    assert reader.read(*payload(NOTHING[State], order), 'a') == []
    assert reader.read(*payload(NOTHING[Gps], order), 'b') == []
    assert (reader.order, reader.held) == (None, 2)
    assert reader.read(*payload(STATE, order), 'c') == [
        (NOTHING[State], 'a'), (NOTHING[Gps], 'b'), (STATE, 'c')]
    assert (reader.order, reader.held) == (order, 0)
    assert reader.read(*payload(NOTHING[State], order), 'd') == [(NOTHING[State], 'd')]


def test_a_known_order_stays_and_is_doubted():
    """An answer that can only be read in the other is read in the one that is known, and told."""
    reader = PayloadReader()
    reader.read(*payload(STATE, 'little'), 0)
    (message, _), = reader.read(*payload(STATE, 'big'), 1)
    assert message != STATE and reader.order == 'little' and reader.doubted
    reader.read(*payload(STATE, 'little'), 2)
    assert not reader.doubted
    reader.begin()
    assert reader.read(*payload(STATE, 'big'), 3) == [(STATE, 3)]


def test_a_forced_order_holds_nothing():
    """Whatever the answers say."""
    reader = PayloadReader('big')
    assert reader.read(*payload(NOTHING[State], 'big'), 0) == [(NOTHING[State], 0)]
    (message, _), = reader.read(*payload(STATE, 'little'), 1)
    assert message != STATE and reader.doubted


def test_a_single_doubtful_number_does_not_decide():
    """1e-12 m/s can be in neither order; the rest tells."""
    odd = State((0.0,) * 3, (1e-12, 0.0, 0.0), (0.0,) * 3, (0.0,) * 3)
    reader = PayloadReader()
    assert reader.read(*payload(odd, 'little'), 0) == []
    assert reader.order is None


def test_no_more_than_so_many_are_held():
    """The oldest go first, and are counted."""
    reader = PayloadReader(most_held=3)
    for tag in range(5):
        reader.read(*payload(NOTHING[State], 'little'), tag)
    assert (reader.held, reader.given_up) == (3, 2)
    assert [tag for _, tag in reader.read(*payload(GPS, 'big'), 9)] == [3, 4, 9]
    assert reader.order == 'big'


def either_sign(least, most):
    """Return numbers that are neither tiny nor large."""
    return st.one_of(st.floats(least, most, width=32), st.floats(-most, -least, width=32))


triples = st.tuples(*[either_sign(2 ** -10, 50)] * 3)
angles = st.tuples(*[either_sign(2 ** -10, 3)] * 3)


@given(st.lists(st.builds(State, triples, triples, angles, triples), min_size=4, max_size=4),
       st.sampled_from(ORDERS))
def test_ordinary_states_never_tell_the_wrong_order(states, order):
    """And a few of them tell the right one."""
    reader = PayloadReader()
    for index, state in enumerate(states):
        reader.read(*payload(state, order), index)
    assert reader.order in (order, None)


def test_sensors_alone_tell():
    """Three numbers of the calibrated ones, the pressure and the temperature."""
    reader = PayloadReader()
    for _ in range(3):
        reader.read(*payload(SENSORS, 'big'), 0)
    assert reader.order == 'big'
