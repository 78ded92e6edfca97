# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Compare the emulator's truth with the topics of the driver."""

import json
import math
from types import SimpleNamespace

from bahrs_driver.convert.axes import flu_to_enu, quaternion_from_euler
from bahrs_driver.emulator.flights import Flight
from bahrs_driver.protocol.bahrs.messages import FORCE, RATE, VELOCITY
import pytest
from sensor_msgs.msg import Imu, NavSatFix
from std_msgs.msg import Float64
from support.emulated import emissions, make_device
from support.processes import driver, listening, running, wait_for
from support.ros_messages import as_messages
from support.settings_examples import parts_of

FASTER = 40
ANGLE_ERROR = math.radians(0.01)
HEIGHT_ERROR = 0.2
HALF_QUANTUM = 0.5001


def sensor(convention):
    """Return the parts that the node uses, with its default parameters."""
    return parts_of('bahrs', frame_convention=convention)


@pytest.fixture(scope='module')
def flown():
    """Return (truth, message) of every frame of a whole flight, in fast motion."""
    flight = Flight()
    motion = SimpleNamespace(at=lambda time: flight.at(FASTER * time))
    sent = emissions(make_device(motion), flight.duration / FASTER)
    parts = sensor('enu')
    frames = parts.framer.feed(b''.join(emission.data for emission in sent))
    return list(zip((emission.truth for emission in sent), map(parts.decoder.decode, frames)))


def angle_between(orientation, truth, convention):
    """Return the angle of the rotation from a published orientation to the true one."""
    true = quaternion_from_euler(truth['roll'], truth['pitch'], truth['magnetic_heading'])
    if convention == 'enu':
        true = flu_to_enu(true)
    found = (orientation.w, orientation.x, orientation.y, orientation.z)
    product = abs(sum(a * b for a, b in zip(found, true)))
    return 2 * math.acos(min(1.0, product))


def worst_vector(found, true, quantum, convention):
    """Return the largest difference of a component, in quanta."""
    sign = -1 if convention == 'enu' else 1
    x, y, z = true
    return max(abs(found.x - x), abs(found.y - sign * y), abs(found.z - sign * z)) / quantum


@pytest.mark.parametrize('convention', ['enu', 'ned'])
def test_topics_agree_with_the_truth(flown, convention):
    """The flight goes above 4,500 m, and through north and south."""
    converter = sensor(convention).converter
    inertial, navigation, seen = {}, {}, []
    worst = dict.fromkeys(('force', 'rate', 'angle', 'heading', 'height', 'velocity'), 0.0)

    def note(name, value):
        worst[name] = max(worst[name], value)

    sign = -1 if convention == 'enu' else 1
    for truth, message in flown:
        if message.NAME == 'inertial':
            inertial = truth
        elif message.NAME == 'navigation':
            navigation = truth
        for topic, out in as_messages(converter.convert(message, 10 ** 9)):
            if topic == 'imu/data_raw':
                note('force', worst_vector(out.linear_acceleration, inertial['specific_force'],
                                           FORCE, convention))
                note('rate', worst_vector(out.angular_velocity, inertial['angular_rate'],
                                          RATE, convention))
            elif topic == 'imu/data' and out.orientation_covariance[0] >= 0:
                note('angle', angle_between(out.orientation, navigation, convention))
            elif topic == 'attitude/rpy' and not math.isnan(out.vector.x + out.vector.z):
                orientation = quaternion_from_euler(out.vector.x, out.vector.y, out.vector.z)
                note('angle', angle_between(orientation, navigation, convention))
            elif topic == 'pressure_altitude':
                note('height', abs(out.altitude - navigation['pressure_height']))
                seen.append((out.altitude, navigation['magnetic_heading']))
            elif topic == 'velocity':
                true = sign * navigation['velocity_down']
                note('velocity', abs(out.twist.twist.linear.z - true) / VELOCITY)
            elif topic == 'heading' and not math.isnan(out.data):
                true = math.degrees(navigation['magnetic_heading'])
                note('heading', abs(math.remainder(out.data - true, 360.0)))
    assert worst['force'] <= HALF_QUANTUM and worst['rate'] <= HALF_QUANTUM
    assert worst['velocity'] <= HALF_QUANTUM
    assert worst['height'] <= HEIGHT_ERROR
    assert worst['angle'] <= ANGLE_ERROR and worst['heading'] <= 0.01
    assert max(height for height, _ in seen) > 5990.0
    headings = [heading for _, heading in seen]
    jumps = [b - a for a, b in zip(headings, headings[1:])]
    assert max(jumps) > 6 and min(jumps) < -6                   # through north, both ways
    assert any((a - math.pi) * (b - math.pi) < 0 for a, b in zip(headings, headings[1:]))


def places(found, true):
    """Return the positions of the headings in the truth, as long as they are in order."""
    positions = []
    for heading in found:
        rest = range(positions[-1] + 1 if positions else 0, len(true))
        near = (index for index in rest if abs(math.remainder(true[index] - heading, 360)) <= 0.01)
        position = next(near, None)
        if position is None:
            break
        positions.append(position)
    return positions


def test_a_subscriber_receives_the_truth(tmp_path):
    """Port, node and middleware are real, in processes of their own."""
    link, truth_file = str(tmp_path / 'port'), tmp_path / 'truth.jsonl'
    topics = {'heading': Float64, 'pressure_altitude': NavSatFix, 'imu/data_raw': Imu}
    with listening(topics) as ear:
        with running('bahrs', 'emulate', '--link', link, '--wait', '--motion', 'steady-turn',
                     '--noise', 'specific_force=0', '--noise', 'angular_rate=0',
                     '--truth', str(truth_file)):
            with driver(link) as node:
                assert wait_for(lambda: len(ear.messages['heading']) >= 300), node.text
        heard = {topic: list(messages) for topic, messages in ear.messages.items()}
    lines = [json.loads(line) for line in truth_file.read_text().splitlines()]
    true = [math.degrees(line['magnetic_heading']) for line in lines
            if line['message'] == 'navigation']
    found = [message.data for message in heard['heading'] if not math.isnan(message.data)]
    positions = places(found, true)
    # Who sleeps for longer than the driver's queue is long misses what came meanwhile, no more.
    gaps = sum(after - before > 1 for before, after in zip(positions, positions[1:]))
    assert found and len(positions) == len(found) and gaps <= 10
    inertial = next(line for line in lines if line['message'] == 'inertial')
    for message in heard['imu/data_raw']:
        assert worst_vector(message.linear_acceleration, inertial['specific_force'], FORCE,
                            'enu') <= HALF_QUANTUM
        assert worst_vector(message.angular_velocity, inertial['angular_rate'], RATE,
                            'enu') <= HALF_QUANTUM
    assert all(abs(message.altitude - 5000.0) <= HEIGHT_ERROR
               for message in heard['pressure_altitude'])
