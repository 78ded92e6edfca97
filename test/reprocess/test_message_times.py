# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the device times of messages in streams with known times."""

from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, Inertial, InertialTime, Navigation, NavigationTime, SoftwareVersion,
)
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.reprocess.message_times import MOST_HELD, with_device_time
from hypothesis import example, given, strategies as st
import pytest

SAFE = (Integrity.SAFE,) * 6
START = 2_000_000           # us


def stream(samples, start=START, ahead=1, ppm=0, first=0):
    """Return the messages of a device with their true device times in us."""
    found = []
    for index in range(samples):
        time = start + round(index * 5000 * (1 + ppm * 1e-6))
        sequence, number = (first + index) % 256, index // 2
        found.append((Inertial(sequence, (0.0,) * 3, (0.0,) * 3, SAFE), time))
        if index % 20 == 0:
            found.append((InertialTime(0, (sequence + ahead) % 256, time), time))
        if index % 2 == 0:
            found.append((Navigation(number % 256, 0.0, 0.0, 0.0, 0.0, 0.0, SAFE[:5]), time))
        if index % 20 == 0:
            found.append((Accuracy(0, 0.0, 0.0, 0.0, time), time))
            found.append((NavigationTime(0, (number + ahead) % 256, time), time))
    return found


def times(found):
    """Return the computed and the true time of each message of a stream."""
    made = [*with_device_time(((None, message) for message, _ in found), ROLES)]
    assert [message for _, message, _ in made] == [message for message, _ in found]
    return [(time, true) for (*_, time), (_, true) in zip(made, found)]


@given(ahead=st.integers(0, 1), ppm=st.integers(-200, 200), first=st.integers(0, 255),
       begin=st.integers(0, 200), end=st.integers(0, 200))
def test_every_message_of_a_good_stream_has_its_time(ahead, ppm, first, begin, end):
    """This holds before the first time message and after the last one, too."""
    found = stream(600, START, ahead, ppm, first)
    made = times(found[begin:len(found) - end])
    assert all(abs(time - true) <= 10 for time, true in made)


@pytest.mark.slow
@example(ahead=1, lost={0, 5}, gap=0, place=0, again=0)     # no sample beside the first message
@example(ahead=0, lost={*range(5), 33}, gap=0, place=0, again=0)      # none before it
@given(ahead=st.integers(0, 1), lost=st.sets(st.integers(0, 1200), max_size=600),
       gap=st.integers(0, 420), place=st.integers(0, 1200), again=st.integers(0, 10 ** 6))
def test_losses_and_restarts_give_no_wrong_time(ahead, lost, gap, place, again):
    """The time of each message is right, or None."""
    found = stream(700, ahead=ahead)
    found = found[:place] + found[place + gap:] + [
        (SoftwareVersion('OSS', 1, 2), None), *stream(300, again, ahead)]
    found = [item for index, item in enumerate(found) if index not in lost]
    made = times(found)
    assert all(time is None or true is not None and abs(time - true) <= 10
               for time, true in made)
    # Most have one: there are ten time messages per second.
    assert sum(time is not None for time, _ in made[-300:]) > 200


def test_a_device_without_a_time():
    """Zeros are not times: messages have none until the first valid time message."""
    zero = {InertialTime: InertialTime(0, 0, 0), NavigationTime: NavigationTime(0, 0, 0)}
    early = [(zero.get(type(message), message), None)
             for message, _ in stream(81) if not isinstance(message, Accuracy)]
    made = times([*early, *stream(100, first=81)])
    assert [time for time, _ in made[:len(early)]] == [None] * len(early)
    assert all(time == true for time, true in made[len(early):])


def test_the_end_after_a_restart():
    """Without another time message, device time is unknown."""
    rest = [(message, None) for message, _ in stream(15, 0, first=77)
            if isinstance(message, (Inertial, Navigation))]
    made = times([*stream(500), *rest])
    assert [time for time, _ in made[-len(rest):]] == [None] * len(rest)
    assert all(time == true for time, true in made[:-len(rest)])


def test_one_wrong_time_message():
    """No other message gets a wrong time."""
    found = stream(600)
    place = next(index for index, (message, _) in enumerate(found)
                 if index > 400 and isinstance(message, InertialTime))
    message, true = found[place]
    found[place] = InertialTime(0, message.reference_sequence, 10 ** 9), true
    made = [item for index, item in enumerate(times(found)) if index != place]
    assert all(time is None or time == true for time, true in made)
    assert sum(time is None for time, _ in made) <= 40


def test_number_of_held_messages_is_limited():
    """Messages of a stream without time messages are returned without times."""
    taken = 0

    def source():
        nonlocal taken
        for message, _ in stream(3 * MOST_HELD):
            if isinstance(message, (Inertial, Navigation)):
                taken += 1
                yield None, message

    for index, (_, _, time) in enumerate(with_device_time(source(), ROLES)):
        assert time is None and taken <= index + MOST_HELD + 1


def test_messages_are_held_for_a_tenth_of_a_second():
    """So messages from a pipe are printed while the device sends."""
    taken = 0

    def source():
        nonlocal taken
        for message, _ in stream(1000):
            taken += 1
            yield None, message

    assert max(taken - index for index, _ in enumerate(with_device_time(source(), ROLES))) < 80
