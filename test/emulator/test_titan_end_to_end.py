# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Compare an emulated Titan-M with the topics, in simulated time and as processes."""

import json
import math

from bahrs_driver.convert.axes import flu_to_enu, quaternion_from_euler
from bahrs_driver.convert.titan_m.converter import TOPICS
from bahrs_driver.emulator.flights import Flight, SteadyTurn
from bahrs_driver.emulator.measurement_errors import DEVIATIONS, MeasurementErrors
from bahrs_driver.emulator.titan_m.measurements import MAX_DIFFERENTIAL_PRESSURE
from bahrs_driver.protocol.titan_m.messages import (
    ADC_FORCE,
    ADC_RATE_DEG,
    DIFFERENTIAL_PRESSURE,
    FIELD,
    GpsRequest,
    PRESSURE,
    SensorsRequest,
    StateRequest,
    TitanAnswer,
)
from bahrs_driver.protocol.titan_m.poller import PollOptions
from bahrs_driver.virtual_serial.cable import AT_ONCE
import numpy as np
import pytest
from support.devices import DIAGNOSTICS, status
from support.polled import make_titan, PolledDevice
from support.processes import driver, listening, running, wait_for
from support.ros_messages import as_messages
from support.settings_examples import parts_of

START = (-0.04, 6.03)           # degrees; the flight crosses the equator and 6 degrees east
SLOW = {SensorsRequest: 2.0, StateRequest: 2.0, GpsRequest: 2.0}
HALF = 0.5001                   # quantum
ONE_IN_A_HUNDRED = {'bit_flip': 0.01 / 56}      # of bytes, of 56 in an answer
MESSAGES = ('gps', 'state', 'sensors')
NS = 10 ** 9
SPHERE = 6_378_137.0


def converter(**changes):
    """Return the converter of the node with some parameters changed."""
    return parts_of('titan_m', **changes).converter


def quanta(value):
    """Return the distance between neighbouring floats of four bytes."""
    return float(np.spacing(np.float32(abs(value))))


def worst(found, true, quantum):
    """Return the largest difference of a component in quanta."""
    return max(abs(a - b) / (quantum(b) if callable(quantum) else quantum)
               for a, b in zip(found, true))


def metres(fix, truth):
    """Return the horizontal and the vertical error of a fix."""
    north = math.radians(fix.latitude - truth['latitude']) * SPHERE
    east = math.radians(math.remainder(fix.longitude - truth['longitude'], 360)) * SPHERE \
        * math.cos(math.radians(truth['latitude']))
    return math.hypot(north, east), abs(fix.altitude - truth['altitude'])


def turn_between(orientation, attitude):
    """Return the angle (rad) of the rotation from a published orientation to the true one."""
    true = flu_to_enu(quaternion_from_euler(*attitude))
    w, x, y, z = orientation.w, orientation.x, orientation.y, orientation.z
    a, b, c, d = true
    vector = (w * b - x * a - y * d + z * c, w * c + x * d - y * a - z * b,
              w * d - x * c + y * b - z * a)
    return 2 * math.asin(min(1.0, math.hypot(*vector)))


def enu(ned):
    """Return a world vector in the published convention."""
    return ned[1], ned[0], -ned[2]


def flu(frd):
    """Return a body vector in the published convention."""
    return frd[0], -frd[1], -frd[2]


def xyz(vector):
    """Return a message's vector as a tuple."""
    return vector.x, vector.y, vector.z


@pytest.mark.parametrize('payload, checksum, length', [
    ('little', 'big', 0x3A), ('big', 'little', 0x2E)])
def test_a_whole_flight_across_the_equator_and_a_zone_border(payload, checksum, length):
    """The error of published values is at most 2 cm and one quantum of the wire format."""
    flight = Flight()
    polled = PolledDevice(make_titan(
        flight, START, payload_order=payload, checksum_order=checksum, request_order=checksum,
        sensors_length=length), SLOW)
    polled.run(flight.duration)
    parts, seen = converter(), set()
    assert len(polled.received) > 7000
    assert len(polled.sent) - len(polled.received) <= 1         # one may be under way
    for _, item in polled.received[:5]:         # odometry needs a fix before it
        list(parts.convert(item.message, item.stamp_ns))
    for (_, item), sent in zip(polled.received, polled.sent):
        truth = sent.emission.truth
        ros = dict(as_messages(parts.convert(item.message, item.stamp_ns)))
        # The middle of request and answer is off by half of what the device took.
        assert abs(item.stamp_ns - sent.emission.time * NS) < 0.5e6
        if 'fix' in ros:
            across, up = metres(ros['fix'], truth)
            assert across < 0.02 and up <= 0.0051
            seen.add((truth['zone'], truth['northern']))
        if 'velocity' in ros:
            assert worst(xyz(ros['velocity'].twist.twist.linear), enu(truth['velocity_ned']),
                         quanta) <= 1
            assert worst(xyz(ros['odometry'].pose.pose.position), enu(truth['position_ned']),
                         quanta) <= 1
            heading = math.degrees(truth['attitude'][2])
            assert abs(math.remainder(ros['heading'].data - heading, 360)) <= 1.5e-5
            assert turn_between(ros['imu/data'].orientation, truth['attitude']) < 4 * quanta(3)
        if 'imu/data_raw' in ros:
            raw = ros['imu/data_raw']
            assert worst(xyz(raw.linear_acceleration), flu(truth['acceleration']),
                         ADC_FORCE) <= HALF
            assert worst(xyz(raw.angular_velocity), flu(truth['angular_rate']),
                         math.radians(ADC_RATE_DEG)) <= HALF
            assert worst(xyz(ros['imu/mag'].magnetic_field), flu(truth['magnetic_field_tesla']),
                         FIELD) <= HALF
            assert worst([ros['static_pressure'].fluid_pressure], [truth['absolute_pressure']],
                         PRESSURE) <= HALF
            assert worst([ros['differential_pressure'].fluid_pressure],
                         [min(truth['differential_pressure'], MAX_DIFFERENTIAL_PRESSURE)],
                         DIFFERENTIAL_PRESSURE) <= HALF
    assert {zone for zone, _ in seen} == {31, 32}
    assert {northern for _, northern in seen} == {True, False}


@pytest.mark.parametrize('length, mode, options', [
    (0x3A, AT_ONCE, PollOptions()),
    (0x2E, 0.001, PollOptions()),
    (0x2E, AT_ONCE, PollOptions(pipelined=True)),
    (0x3A, 0.016, PollOptions(pipelined=True, counted_ids=True)),
])
def test_polling_keeps_its_rates_and_counts_damaged_answers(length, mode, options):
    """Rates of 50, 50 and 10 Hz fit 115,200 baud; one answer in a hundred is damaged."""
    seconds = 60.0
    device = make_titan(SteadyTurn(), (0.0, 6.0), MeasurementErrors(1, DEVIATIONS),
                        sensors_length=length)
    polled = PolledDevice(device, mode=mode, faults=ONE_IN_A_HUNDRED, options=options)
    polled.run(seconds)
    poller = polled.poller
    for kind, rate in ((StateRequest, 50), (SensorsRequest, 50), (GpsRequest, 10)):
        assert poller.answered[kind] >= 0.985 * rate * seconds
        assert poller.answered[kind] <= rate * seconds + 1
    # Truth: what the cable damaged on its way back, and on its way there.
    intact = [sent for sent in polled.sent if sent.fate == 'intact']
    damaged = len(polled.sent) - len(intact)
    unheard = polled.asked_bytes // 8 - len(polled.sent)
    assert damaged > 50 and unheard > 0
    under_way = len(poller.expected())
    assert damaged + unheard <= poller.unanswered.total() + under_way
    assert poller.unanswered.total() <= damaged + unheard
    assert poller.unexpected.total() == 0 and poller.lost.total() <= 3
    # Every answer is, byte for byte, one that the device gave, in order, under its own time.
    assert len(intact) - len(polled.received) <= under_way
    for (read, item), sent in zip(polled.received, intact):
        assert item.frame.data == sent.emission.data
        assert item.message.NAME == sent.emission.name
        asked = polled.requested[item.frame.offset]
        assert asked <= sent.emission.time * NS <= read * NS
        assert asked < item.stamp_ns < read * NS


def test_late_and_repeated_answers_are_counted_and_dropped():
    """The device is often late, and the line repeats frames."""
    device = make_titan(late_share=0.02)
    polled = PolledDevice(device, faults={'repeat_frame': 0.02})
    polled.run(60.0)
    poller = polled.poller
    taken = [item for _, item in polled.received if isinstance(item.message, TitanAnswer)]
    times = [polled.requested[item.frame.offset] for item in taken]
    assert len(set(times)) == len(times) == poller.answered.total()
    assert poller.unexpected.total() > 50
    assert len(polled.received) - len(taken) == poller.unexpected.total()
    assert poller.answered[StateRequest] > 2500


def test_polling_resumes_after_a_power_cycle():
    """The device is silent for a second, and only answers in that time are lost."""
    polled = PolledDevice()
    polled.run(5.0)
    before = polled.poller.answered.total()
    polled.device.power_cycle(5.0)
    polled.run(6.0)
    assert polled.poller.answered.total() <= before + 1         # one was under way
    polled.run(10.0)
    assert polled.poller.answered.total() - before > 0.9 * 110 * 4


def counted(ear):
    """Return the values of the latest status of the task Requests, if any."""
    latest = status(ear, 'Requests')
    return {pair.key: pair.value for pair in latest.values} if latest else {}


def test_subscribers_receive_the_truth(tmp_path):
    """Values and counts agree with the truth; one answer in a hundred is damaged."""
    link, truth_file = str(tmp_path / 'port'), tmp_path / 'truth.jsonl'
    with listening({**TOPICS, **DIAGNOSTICS}) as ear:
        with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', link, '--wait',
                     '--motion', 'steady-turn', '--start', '0,6', '--sensors-len', '0x2E',
                     '--payload-order', 'big', '--noise', 'angular_rate=0',
                     '--fault', f'bit_flip={0.01 / 56}', '--truth', str(truth_file)) as emulator:
            assert wait_for(lambda: emulator.lines)
            with driver(link, sensor='titan_m') as node:
                for topic in TOPICS:
                    ear.wait(topic)
                ear.wait('fix', 60)
                assert wait_for(lambda: all(int(counted(ear).get(f'{name} answered', 0))
                                            for name in MESSAGES)), node.text
                assert node.alive and len(node.lines) == 1, node.text
                values = counted(ear)
                assert node.end() == 0
            emulator.end()
        heard = {topic: list(messages) for topic, messages in ear.messages.items()}
    lines = [json.loads(line) for line in truth_file.read_text().splitlines()]
    true = {name: [line for line in lines if line['message'] == name]
            for name in MESSAGES}
    for fix in heard['fix']:
        across, up = min(metres(fix, line) for line in true['gps'])
        assert across < 0.02 and up < 0.0051
    velocities = [enu(line['velocity_ned']) for line in true['state']]
    for message in heard['velocity']:
        found = xyz(message.twist.twist.linear)
        assert min(math.dist(found, velocity) for velocity in velocities) < 1e-5
    for name, topic in (('gps', 'fix'), ('state', 'heading'), ('sensors', 'temperature')):
        intact = sum(line['wire'] == 'intact' for line in true[name])
        assert int(values[f'{name} answered']) <= intact
        assert len(heard[topic]) <= intact
        assert int(values[f'{name} requests']) >= int(values[f'{name} answered'])
