# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the clock with the stream of a real device, and a simulated adapter and host."""

from bahrs_driver.clock import SampleClock
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Inertial, InertialTime, Navigation
from bahrs_driver.protocol.bahrs.roles import ROLES
from bahrs_driver.protocol.framing import Framer
from clock_simulation import BYTE_TIME, Case, ORIGIN, Sent, Simulation
import pytest
from support.shared_files import shared_file

DRIFT = 25e-6
SECONDS = 60
PAUSE_BEFORE = 16       # somewhere between the first time message and the second


class Recorded(Sent):
    """A message of the recording; its size is that of its version."""

    size = 24


@pytest.fixture(scope='module')
def messages():
    """Return the messages of the recording's first minute."""
    data = shared_file('data/bahrs_recording_v2.bin').read_bytes()[:SECONDS * 7900]
    codec = BahrsCodec()
    return [codec.decode(frame) for frame in Framer(BahrsFormat()).feed(data)]


def sent(messages):
    """Return the messages, each ready when its sample was taken."""
    start, second = [message.device_time_us for message in messages
                     if isinstance(message, InertialTime)][:2]
    pause, count = second - start - 20 * 5000, -1
    for message in messages:
        count += isinstance(message, Inertial)
        device = start + 5000 * count + pause * (count >= PAUSE_BEFORE)
        true = ORIGIN + round(device * 1000 * (1 + DRIFT))
        yield Recorded(true, message, true, device * 1000)


@pytest.mark.parametrize('adapter', [0.016, 'packets', 'plain'])
def test_real_stream(messages, adapter):
    """Check the convention, period, settling, epochs and order."""
    simulation, clock = Simulation(Case(adapter=adapter), 1), SampleClock(ROLES)
    clock.begin(BYTE_TIME)
    stamps, paired, samples, time_messages, settled_after = [], {}, 0, 0, None
    for now, received, batch in simulation.reads(sent(messages)):
        clock.observe_read(now, received)
        samples += sum(isinstance(message, Inertial) for message, _ in batch)
        time_messages += sum(isinstance(message, InertialTime) for message, _ in batch)
        for message, frame, stamp in clock.stamp(batch):
            if isinstance(message, Inertial):
                stamps.append((stamp, simulation.truths[frame.offset], now.ros_ns))
                latest = stamp
            elif isinstance(message, Navigation):
                paired[stamp] = latest
        state = clock.state()
        if settled_after is None and state.settled and time_messages > 1:
            settled_after = time_messages
        if time_messages > 3:
            assert state.held == 0 and state.epochs == 1
    assert settled_after <= 3
    assert state.label == 'next'
    assert state.period_us == pytest.approx(5000, rel=10e-6)
    assert state.dropped == state.arrival_stamps == state.rejected_time_messages == 0
    assert len(stamps) == samples
    assert all(later > earlier for (earlier, *_), (later, *_) in zip(stamps, stamps[1:]))
    assert all(stamp <= read for stamp, _, read in stamps)
    assert all(stamp == inertial for stamp, inertial in paired.items())
    offsets = [stamp - truth for stamp, truth, _ in stamps[2000:]]
    assert max(offsets) - min(offsets) < 150_000
