# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the emulated BAHRS: bytes, ground truth, power switch."""

import math
from types import SimpleNamespace

from bahrs_driver.emulator.bahrs.device import HARDWARE, SOFTWARE
from bahrs_driver.emulator.flights import Flight
from bahrs_driver.emulator.measurement_errors import DEVIATIONS, MeasurementErrors
from bahrs_driver.protocol.bahrs.frames import BahrsFormat
from bahrs_driver.protocol.bahrs.messages import (
    ANGLE,
    FORCE,
    HEIGHT,
    InertialTime,
    NavigationTime,
    RATE,
    SyncPulseTime,
    VELOCITY,
)
from bahrs_driver.protocol.framing import Framer
import pytest
from support.emulated import decoded, emissions, make_device, make_emulation, on_the_wire

FASTER = 20
# From truth to wire and back is at most half a quantum, and a hair for the last digit.
QUANTA = {'pressure_height': HEIGHT, 'velocity_down': VELOCITY, 'roll': ANGLE, 'pitch': ANGLE,
          'magnetic_heading': ANGLE, 'specific_force': FORCE, 'angular_rate': RATE}
HALF = 0.5001


def fast_flight():
    """Return the whole flight, in fast motion; the truth of each instant is unchanged."""
    flight = Flight()
    return SimpleNamespace(at=lambda time: flight.at(FASTER * time),
                           duration=flight.duration / FASTER)


def data_of(sent):
    """Return the bytes of emissions."""
    return b''.join(emission.data for emission in sent)


def errors(emission, message):
    """Return the error of each value of a message in quanta."""
    for name, quantum in QUANTA.items():
        if name not in emission.truth:
            continue
        true, told = emission.truth[name], getattr(message, name)
        for a, b in zip(true, told) if isinstance(true, tuple) else [(true, told)]:
            difference = a - b
            if name == 'magnetic_heading':
                difference = math.remainder(difference, 2 * math.pi)
            yield difference / quantum


@pytest.mark.parametrize('crc', ['word', 'byte'])
@pytest.mark.parametrize('version', [1, 2, 3])
def test_frames_agree_with_truth(version, crc):
    """Over the whole flight and in every version, each error is at most half a quantum."""
    motion = fast_flight()
    sent = emissions(make_device(motion, version=version, crc=crc), motion.duration)
    messages = decoded(data_of(sent))
    assert [emission.name for emission in sent] == [message.NAME for message in messages]
    worst = 0.0
    for emission, message in zip(sent, messages):
        if not any(getattr(message, 'health', (True,))):
            continue
        worst = max([worst, *map(abs, errors(emission, message))])
    assert 0.4 < worst <= HALF


def test_the_truth_of_a_frame_names_it():
    """The truth has counter and device time, even of messages without a time."""
    sent = emissions(make_device(), 2.0)
    inertial = [emission for emission in sent if emission.name == 'inertial']
    assert [emission.truth['sequence'] for emission in inertial[:300]] == [
        index % 256 for index in range(len(inertial[:300]))]
    assert [emission.truth['device_time_us'] for emission in inertial[:3]] == [
        600_000, 605_000, 610_000]
    assert [emission.time for emission in inertial[:3]] == pytest.approx([0.6, 0.605, 0.61])


def test_versions_are_sent_once_after_power_on():
    """All versions send the software version, version 3 the hardware version, too."""
    assert decoded(data_of(emissions(make_device(version=3), 1.0)))[:2] == [SOFTWARE, HARDWARE]
    older = decoded(data_of(emissions(make_device(version=2), 9.0)))
    assert older[0] == SOFTWARE
    assert {message.NAME for message in older[1:]} == {
        'inertial', 'navigation', 'accuracy', 'inertial_time', 'navigation_time'}


def test_the_recorded_start_up():
    """Time messages 2.58 s and then 5.38 s after power-on, twenty samples between them."""
    messages = decoded(data_of(emissions(make_device(version=2, start_up='recorded'), 6.0)))
    times = [message for message in messages if isinstance(message, InertialTime)]
    assert [(time.reference_sequence, time.device_time_us) for time in times[:3]] == [
        (1, 2_581_377), (21, 5_381_414), (41, 5_481_414)]
    navigation = [message for message in messages if isinstance(message, NavigationTime)]
    assert [(time.reference_sequence, time.device_time_us) for time in navigation[:2]] == [
        (0, 0), (11, 5_381_414)]


def test_a_power_cycle_restarts_the_device():
    """Versions are sent, counters and device time restart; the vehicle continues."""
    device = make_device(fast_flight())
    emissions(device, 10.0)
    device.power_cycle(10.001)
    sent = emissions(device, 12.0)
    messages = decoded(data_of(sent))
    assert messages[0] == SOFTWARE
    first = next(emission for emission in sent if emission.name == 'inertial')
    assert first.truth['sequence'] == 0 and first.truth['device_time_us'] == 600_000
    assert first.time == pytest.approx(10.601)
    true = fast_flight().at(10.601)
    assert first.truth['specific_force'] == pytest.approx(true.specific_force)


def test_sync_pulses_carry_their_own_time():
    """The message has the device time of the pulse, not of the next sample."""
    sent = [emission for emission in emissions(make_device(drift_ppm=100.0, pulse_rate=1.0), 60.0)
            if emission.name == 'sync_pulse_time']
    messages = decoded(data_of(sent))
    assert [emission.time for emission in sent] == [float(index) for index in range(1, 60)]
    assert all(isinstance(message, SyncPulseTime) for message in messages)
    assert [message.device_time_us for message in messages] == [
        index * 1_000_100 for index in range(1, 60)]
    assert [message.sequence for message in messages] == list(range(59))


def test_debug_frames_have_unknown_types():
    """The frames around them stay intact."""
    sent = emissions(make_device(debug_rate=10.0), 4.999)
    framer = Framer(BahrsFormat())
    frames = framer.feed(data_of(sent)) + framer.flush()
    unknown = framer.counters.unknown_types
    assert unknown['0xC0'] == unknown['0xC1'] == 44
    assert len(frames) == len(sent) - 88 and framer.counters.skipped_bytes == 0


def test_the_output_can_come_late():
    """The delay between a sample and its frame is constant."""
    sent = emissions(make_device(output_delay=0.002), 1.0)
    assert len(sent) > 100
    assert all(emission.ready == pytest.approx(emission.time + 0.002) for emission in sent)


def test_noise_is_the_only_error():
    """The noise has the requested standard deviation."""
    sent = emissions(make_device(errors=MeasurementErrors(1, DEVIATIONS)), 30.0)
    inertial = [emission for emission in sent if emission.name == 'inertial']
    messages = decoded(data_of(inertial))
    spread = sum((message.specific_force[0] - emission.truth['specific_force'][0]) ** 2
                 for message, emission in zip(messages, inertial)) / len(messages)
    assert math.sqrt(spread) == pytest.approx(0.008, rel=0.05)


def test_the_same_seed_gives_the_same_bytes():
    """This includes everything random; another seed gives other bytes."""
    def stream(seed):
        device = make_device(fast_flight(), seed, MeasurementErrors(seed, DEVIATIONS),
                             wander_ppm=1.0,
                             pulse_rate=5.0)
        rates = {'bit_flip': 1e-3, 'drop_byte': 1e-3, 'drop_frame': 1e-2, 'break_': 1e-2,
                 'insert_byte': 1e-3, 'repeat_byte': 1e-3}
        return on_the_wire(make_emulation(device, seed, **rates), 20.0)[1]

    assert stream(5) == stream(5) != stream(6)
