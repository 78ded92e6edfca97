# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the stamp of each type of message, with literal times."""

from bahrs_driver.clock import Instant, SampleClock
from bahrs_driver.protocol.bahrs.messages import Inertial, InertialTime, Navigation, SyncPulseTime
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Frame
from hypothesis import given, strategies as st

ROS = 10 ** 18
RAW = 10 ** 12
PERIOD_US = 5000
START_US = 700_000
LATE_US = 3000


def inertial(count):
    """Return the inertial message of a count."""
    return Inertial(count % 256, (), (), ())


def navigation(count):
    """Return the navigation message of a sample."""
    return Navigation(count // 2 % 256, 0.0, 0.0, 0.0, 0.0, 0.0, ())


def stream(samples, extra):
    """Yield the messages of each sample in the order of the line; extra ones come last."""
    for count in range(samples):
        messages = [inertial(count)]
        if count % 20 == 0:
            messages.append(InertialTime(0, (count + 1) % 256, START_US + count * PERIOD_US))
        if count % 2 == 0:
            messages.append(navigation(count))
        yield messages + extra.get(count, [])


def stamps(samples, extra):
    """Return (message, stamp minus that of device time 0 in us), one read per sample."""
    clock, stamped, received = SampleClock(ROLES), [], 0
    clock.begin(0)
    for count, messages in enumerate(stream(samples, extra)):
        frames = [Frame(received + 20 * place, bytes(20), 'word')
                  for place in range(len(messages))]
        received += 20 * len(messages)
        raw = RAW + 1000 * (START_US + count * PERIOD_US + LATE_US)
        clock.observe_read(Instant(raw, raw + ROS), received)
        stamped += clock.stamp(zip(messages, frames))
    zero = ROS + RAW + 1000 * LATE_US
    return [(message, (stamp - zero) / 1000) for message, _, stamp in stamped]


@given(count=st.integers(40, 99), early_us=st.integers(0, PERIOD_US))
def test_a_pulse_has_a_time_of_its_own(count, early_us):
    """A sample is close to it."""
    time = START_US + count * PERIOD_US - early_us
    pulse = SyncPulseTime(0, time)
    (found,) = (stamp for message, stamp in stamps(100, {count: [pulse]}) if message is pulse)
    assert abs(found - time) < 1


def test_messages_of_one_sample_share_its_stamp():
    """The messages are an inertial, a navigation and a time message."""
    for message, stamp in stamps(100, {}):
        if isinstance(message, InertialTime):
            assert abs(stamp - message.device_time_us) < 0.01
    by_sample = {}
    for message, stamp in stamps(100, {}):
        by_sample.setdefault(stamp, []).append(type(message))
    assert sorted(map(len, by_sample.values())) == [1] * 50 + [2] * 45 + [3] * 5


def test_stamps_of_repeated_frames_increase_strictly():
    """They increase within each type, by a nanosecond only."""
    again = {50: [inertial(50), navigation(50), SyncPulseTime(0, START_US + 50 * PERIOD_US - 100),
                  SyncPulseTime(0, START_US + 50 * PERIOD_US - 100)]}
    stamped = stamps(100, again)
    for kind in (Inertial, Navigation, SyncPulseTime):
        times = [stamp for message, stamp in stamped if isinstance(message, kind)]
        assert times == sorted(set(times))
        assert any(0 < later - earlier < 0.01 for earlier, later in zip(times, times[1:]))
