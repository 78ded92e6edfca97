# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests that messages leave the clock in the order of the stream, for any cuts of it."""

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
    """Return the messages that a clock releases after each read, one read every 5 ms."""
    clock = clock or SampleClock(ROLES)
    clock.begin(0)
    released, received = [], 0
    for index, messages in enumerate(reads):
        raw = 10 ** 9 + index * PERIOD
        frames = [Frame(received + 24 * place, bytes(24), 'word')
                  for place in range(len(messages))]
        received += 24 * len(messages)
        clock.observe_read(Instant(raw, raw + ROS), received)
        released.append([item.message for item in clock.stamp(zip(messages, frames))])
    return released


@settings(max_examples=60)
@given(seed=st.integers(0, 10 ** 6), first_time_message=st.sampled_from([0.0, 0.9, 2.0]),
       loss=st.sampled_from([0.0, 0.01, 0.1]), bad_times=st.sampled_from([0.0, 0.2]),
       sizes=st.lists(st.integers(1, 60), min_size=1, max_size=20))
def test_order_does_not_depend_on_the_cuts_of_the_stream(seed, sizes, **faults):
    """An accuracy message stays between the same two messages."""
    case = Case(4.0, 'plain', restarts=(2.5,), **faults)
    device, clock, released, place = Simulation(case, seed), SampleClock(ROLES), [], 0
    messages = [item for read in device.reads() for item in read.messages]
    clock.begin(BYTE_TIME)
    while place < len(messages):
        batch = messages[place:place + sizes[place % len(sizes)]]
        place += len(batch)
        end = batch[-1][1]
        now = device.truths[end.offset] + LATE
        clock.observe_read(Instant(now, now + ROS), end.offset + len(end.data))
        released += clock.stamp(batch)
    released += clock.end()
    offsets = [item.frame.offset for item in released]
    assert offsets == sorted(offsets)
    untimed = [frame.offset for message, frame in messages
               if not isinstance(message, (InertialTime, NavigationTime))]
    assert set(untimed) <= set(offsets)


def test_messages_behind_a_held_sample_are_held():
    """An accuracy message applies to the navigation messages after it."""
    accuracy = Accuracy(0, 0.1, 0.1, 0.1, 0)
    beginning = [inertial(0), InertialTime(0, 1, 700_000), Navigation(0, *NAVIGATION), accuracy]
    end = [inertial(20), InertialTime(1, 21, 800_000)]
    released = fed([beginning, *([inertial(count)] for count in range(1, 20)), end])
    assert released[:20] == [[]] * 20
    assert released[20] == beginning + [inertial(count) for count in range(1, 20)] + end


def test_messages_without_time_wait_for_samples_only():
    """Before the first sample no message is held."""
    accuracy = Accuracy(0, 0.1, 0.1, 0.1, 0)
    assert fed([[accuracy], [NavigationTime(0, 0, 0)]]) == [
        [accuracy], [NavigationTime(0, 0, 0)]]


def test_an_answer_of_the_device_is_not_held():
    """The device does not stream now, so no time message will follow."""
    answer = Acknowledgement(0xF0, 0)
    assert fed([[inertial(0)], [answer]]) == [[], [inertial(0), answer]]


@pytest.mark.parametrize('kind', [inertial, lambda index: Navigation(index, *NAVIGATION)])
def test_holding_is_bounded(kind):
    """Without time messages, stamps are arrivals, and nothing is held any more."""
    most = ClockOptions().most_held
    released = fed([[kind(index % 256)] for index in range(10 * most)])
    longest = max(len(messages) for messages in released)
    assert most < longest <= 2 * most + 1
    assert [len(messages) for messages in released[-most:]] == [1] * most


def test_samples_before_a_doubted_time_message_are_not_held():
    """A contradicting time message does not apply to the samples before it."""
    clock = SampleClock(ROLES)
    beginning = [inertial(0), InertialTime(0, 1, 700_000), *map(inertial, range(1, 21)),
                 InertialTime(1, 21, 800_000)]
    released = fed([beginning, [inertial(21), InertialTime(2, 22, 5)], [inertial(22)]], clock)
    assert released[1:] == [[inertial(21)], []]
    assert clock.state().held == 2
