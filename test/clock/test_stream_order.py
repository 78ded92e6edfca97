# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Messages leave the clock in the order of the stream, however the adapter cut it."""

from bahrs_driver.clock import ClockOptions, Instant, SampleClock
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, Acknowledgement, Inertial, InertialTime, Navigation, NavigationTime,
)
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Frame
from clock_simulation import BYTE_TIME, Case, Simulation
from hypothesis import given, settings, strategies as st
import pytest

ROS = 10 ** 18
PERIOD = 5_000_000
LATE = 30_000_000
NAVIGATION = (0.0,) * 5 + ((),)


def inertial(sequence):
    """Return an inertial message with a counter."""
    return Inertial(sequence, (), (), ())


def fed(reads, clock=None):
    """Return what a clock gives after each read of messages, one read every 5 ms."""
    clock = clock or SampleClock(ROLES)
    clock.begin(0)
    given_back, received = [], 0
    for index, messages in enumerate(reads):
        raw = 10 ** 9 + index * PERIOD
        frames = [Frame(received + 24 * place, bytes(24), 'word')
                  for place in range(len(messages))]
        received += 24 * len(messages)
        clock.observe_read(Instant(raw, raw + ROS), received)
        given_back.append([item.message for item in clock.stamp(zip(messages, frames))])
    return given_back


@settings(max_examples=60)
@given(seed=st.integers(0, 10 ** 6), first_time_message=st.sampled_from([0.0, 0.9, 2.0]),
       loss=st.sampled_from([0.0, 0.01, 0.1]), bad_times=st.sampled_from([0.0, 0.2]),
       sizes=st.lists(st.integers(1, 60), min_size=1, max_size=20))
def test_order_does_not_depend_on_how_the_stream_is_cut(seed, sizes, **faults):
    """Nothing overtakes, and an accuracy message stays between the same two messages."""
    case = Case(4.0, 'plain', restarts=(2.5,), **faults)
    device, clock, given_back, place = Simulation(case, seed), SampleClock(ROLES), [], 0
    messages = [item for read in device.reads() for item in read.messages]
    clock.begin(BYTE_TIME)
    while place < len(messages):
        batch = messages[place:place + sizes[place % len(sizes)]]
        place += len(batch)
        end = batch[-1][1]
        now = device.truths[end.offset] + LATE
        clock.observe_read(Instant(now, now + ROS), end.offset + len(end.data))
        given_back += clock.stamp(batch)
    given_back += clock.end()
    offsets = [item.frame.offset for item in given_back]
    assert offsets == sorted(offsets)
    untimed = [frame.offset for message, frame in messages
               if not isinstance(message, (InertialTime, NavigationTime))]
    assert set(untimed) <= set(offsets)


def test_what_follows_a_held_sample_is_held_with_it():
    """The accuracy speaks of the navigation messages behind it."""
    accuracy = Accuracy(0, 0.1, 0.1, 0.1, 0)
    beginning = [inertial(0), InertialTime(0, 1, 700_000), Navigation(0, *NAVIGATION), accuracy]
    end = [inertial(20), InertialTime(1, 21, 800_000)]
    given_back = fed([beginning, *([inertial(count)] for count in range(1, 20)), end])
    assert given_back[:20] == [[]] * 20
    assert given_back[20] == beginning + [inertial(count) for count in range(1, 20)] + end


def test_what_needs_no_time_waits_for_nothing_but_samples():
    """Before the first sample there is nothing to wait for."""
    accuracy = Accuracy(0, 0.1, 0.1, 0.1, 0)
    assert fed([[accuracy], [NavigationTime(0, 0, 0)]]) == [
        [accuracy], [NavigationTime(0, 0, 0)]]


def test_an_answer_of_the_device_is_not_held():
    """It has ceased to stream: whoever asked would wait for ever."""
    answer = Acknowledgement(0xF0, 0)
    assert fed([[inertial(0)], [answer]]) == [[], [inertial(0), answer]]


@pytest.mark.parametrize('kind', [inertial, lambda index: Navigation(index, *NAVIGATION)])
def test_holding_is_bounded(kind):
    """Without a time message all goes on by arrival, and at once."""
    most = ClockOptions().most_held
    given_back = fed([[kind(index % 256)] for index in range(10 * most)])
    longest = max(len(messages) for messages in given_back)
    assert most < longest <= 2 * most + 1
    assert [len(messages) for messages in given_back[-most:]] == [1] * most


def test_what_came_before_a_doubt_is_not_held():
    """A time message that contradicts says nothing of the samples before it."""
    clock = SampleClock(ROLES)
    beginning = [inertial(0), InertialTime(0, 1, 700_000), *map(inertial, range(1, 21)),
                 InertialTime(1, 21, 800_000)]
    given_back = fed([beginning, [inertial(21), InertialTime(2, 22, 5)], [inertial(22)]], clock)
    assert given_back[1:] == [[inertial(21)], []]
    assert clock.state().held == 2
