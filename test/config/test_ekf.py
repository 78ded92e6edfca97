# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What ekf.launch.py starts gives the filter of robot_localization what it needs.

The drivers have the parameters of the launch file and convert an emulated flight, in which signals
are at risk and unavailable. A model of the filter takes what they publish.
"""

from functools import cache
from math import cos, pi, radians
from pathlib import Path

from bahrs_driver.bag.capture import Chunk
from bahrs_driver.devices.mounting import mounting
from bahrs_driver.devices.registry import all_topics, DEVICES
from bahrs_driver.emulator.control import execute
from bahrs_driver.emulator.flights import Flight
from bahrs_driver.reprocess.conversion import Conversion
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from support.conversions import Kept, ORIGIN, Pieces, S
from support.emulated import make_device, make_emulation
from support.launched import install_filter, StandIn
from support.node_settings import node_settings
from support.polled import make_titan, PolledDevice
from support.robot_localization import (
    ANGLES, Filter, MEASURED, of_quaternion, SIZE, sources, wrap,
)
import yaml

CONFIG = Path(__file__).resolve().parents[2] / 'config'
FILES = ('ekf', 'ekf_titan_m')
NODE = 'ekf_filter_node'
TAKE_OFF = 50.0             # s in the flight; then it climbs and turns
PHASES = """
     8 integrity all risk                       |  12 integrity all safe
    13 integrity roll unavailable               |  15 integrity roll safe
    16 integrity angular_rate_x unavailable     |  18 integrity angular_rate_x safe
    19 integrity pressure_height unavailable    |  21 integrity pressure_height safe
    22 integrity magnetic_heading unavailable   |  25 integrity magnetic_heading safe
    26 integrity specific_force unavailable     |  28 integrity specific_force safe
    29 integrity velocity_down unavailable      |  31 integrity velocity_down safe
    32 integrity all unavailable                |  33 integrity all safe
    36 power-cycle
"""
END = 44.0
EARTH_RADIUS = 6.371e6      # m
# Parameters that ekf_node and navsat_transform_node declare, of those that the files set.
KNOWN = {NODE: {'frequency': float, 'sensor_timeout': float, 'two_d_mode': bool,
                'publish_tf': bool, 'print_diagnostics': bool, 'odom_frame': str,
                'base_link_frame': str, 'world_frame': str, 'process_noise_covariance': list,
                'initial_estimate_covariance': list},
         'navsat_transform_node': {
             'frequency': float, 'use_odometry_yaw': bool, 'magnetic_declination_radians': float,
             'yaw_offset': float, 'publish_filtered_gps': bool}}


class Departed:
    """A flight from shortly before take-off."""

    def __init__(self):
        self._flight = Flight()

    def at(self, time):
        """Return the true values."""
        return self._flight.at(TAKE_OFF + time)


def parameters(file, node=NODE):
    """Return the parameters of a node in a file."""
    tree = yaml.safe_load((CONFIG / f'{file}.yaml').read_text())
    return tree.get(f'/**/{node}', tree.get('/**'))['ros__parameters']


@pytest.mark.parametrize('file, node', [*((file, NODE) for file in FILES),
                                        ('ekf_titan_m', 'navsat_transform_node')])
def test_parameters_are_those_of_the_nodes(file, node):
    """A node of robot_localization ignores other names, and refuses other types."""
    given = parameters(file, node)
    inputs = {f'{source.name}{suffix}': kind for source in sources(given)
              for suffix, kind in (('', str), ('_config', list), ('_queue_size', int))}
    assert {name: type(value) for name, value in given.items()}.items() <= {
        **KNOWN[node], **inputs}.items()


@pytest.mark.parametrize('file', FILES)
def test_inputs_are_topics_that_measure_what_is_used(file):
    """With all entries of each config, and all of the diagonals as decimal numbers."""
    given = parameters(file)
    kinds = {'imu': 'Imu', 'pose': 'PoseWithCovarianceStamped',
             'twist': 'TwistWithCovarianceStamped', 'odom': 'Odometry'}
    for source in sources(given):
        assert len(given[f'{source.name}_config']) == SIZE
        assert source.used and source.used <= MEASURED[source.kind]
        if source.topic != 'odometry/gps':
            topic = source.topic.removeprefix('titan_m/')
            assert all_topics()[topic].__name__ == kinds[source.kind]
    for name in ('process_noise_covariance', 'initial_estimate_covariance'):
        assert [type(value) for value in given[name]] == [float] * SIZE


@cache
def flight(phases=PHASES, end=END):
    """Return the chunks of a BAHRS in the flight with its phases."""
    commands = [line.split(maxsplit=1) for line in phases.replace('|', '\n').split('\n')
                if line.strip()]
    emulation, chunks, now = make_emulation(make_device(Departed()), mode=0.016), [], 0.0
    while now < end:
        now += 0.016
        while commands and float(commands[0][0]) <= now:
            execute(commands.pop(0)[1], emulation, now)
        list(emulation.advance(now))
        data = emulation.take(now)
        if data:
            chunks.append(chunk(data, now + 50e-6))
    return chunks


@cache
def polled_flight():
    """Return the chunks of a Titan-M in the same flight, whose GPS needs a while."""
    polled = PolledDevice(make_titan(Departed(), first_fix=4.0))
    polled.run(END)
    return [chunk(data, time) for time, data in polled.chunks]


def chunk(data, time):
    """Return bytes that arrived at a time in seconds."""
    return Chunk(data, ORIGIN + round(time * S), round(time * S))


def published(sensor, command, chunks, tmp_path, incomplete=''):
    """Return the messages of a driver by topic, with their stamps, and its settings."""
    words = ['-p', f'publish.incomplete:={incomplete}'] if incomplete else []
    _, settings = node_settings([command.executable, *command.words, *words])
    kept = Kept()
    Conversion(Pieces(chunks, tmp_path), settings.for_recording(), DEVICES[sensor], None).run(
        kept, lambda what: None)
    return kept.messages, settings


def static_frames(*settings):
    """Return position and rotation of each device in base_link, as on /tf_static."""
    frames = {}
    for each in settings:
        assert each.publish.static_tf
        (message,) = mounting(each).transform(0).transforms
        q = dict(zip('xyzw', message.rotation))
        frames[message.child_frame_id] = (
            np.array(message.translation), of_quaternion(type('Quaternion', (), q)))
    return frames


@pytest.fixture
def drivers(tmp_path, monkeypatch):
    """Return the commands of the drivers that the launch file starts, by the device."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(install_filter(tmp_path)))
    commands, _ = StandIn().run(StandIn().include('ekf', {'titan_m_port': '/dev/t'}))
    return {'titan_m' if 'sensor:=titan_m' in ' '.join(command.words) else 'bahrs': command
            for command in commands if command.executable == 'driver_node'}


def run(model, inputs, notice=lambda model: None):
    """Give messages to a filter in the order of their stamps."""
    items = [(message.header.stamp.sec * S + message.header.stamp.nanosec, number, source, message)
             for number, (source, messages) in enumerate(inputs) for message in messages]
    for *_, source, message in sorted(items, key=lambda item: item[:2]):
        model.take(source, message)
        notice(model)


class Errors:
    """Largest errors of the estimate in each second of the flight."""

    def __init__(self):
        self.height, self.climb, self.angle, self.place, self.speed = (
            np.zeros(int(END) + 1) for _ in range(5))
        self._motion, self._north, self._last = Departed(), np.zeros(2), 0.0

    def __call__(self, model):
        """Compare the estimate with the truth."""
        time = (model.time_ns - ORIGIN) / S
        if not 0 < time < END:
            return
        truth, second = self._motion.at(time), int(time)
        north, east, down = truth.velocity
        attitude = np.array([truth.roll, -truth.pitch, pi / 2 - truth.heading])
        for errors, error in ((self.height, model.state[2] - truth.pressure_height),
                              (self.climb, model.velocity[2] + down),
                              (self.angle, wrap(model.state[ANGLES] - attitude)),
                              (self.place, model.state[:2]),
                              (self.speed, model.velocity[:2] - (east, north))):
            errors[second] = max(errors[second], np.abs(error).max())


def alone(drivers, tmp_path, incomplete='', chunks=None, **changes):
    """Return filter and errors after the flight of a BAHRS, with changed parameters."""
    messages, settings = published('bahrs', drivers['bahrs'], chunks or flight(), tmp_path,
                                   incomplete)
    given, errors = {**parameters('ekf'), **changes}, Errors()
    model = Filter(given, static_frames(settings))
    run(model, [(source, [message for _, message in messages[source.topic]])
                for source in sources(given)], errors)
    return model, errors


# Seconds in which the estimate may be off: at first, without height, and after a power cycle.
UNSETTLED = {0, 19, 20, 21, 36, 37}
SETTLED = sorted(set(range(int(END))) - UNSETTLED)


def test_a_bahrs_alone(drivers, tmp_path):
    """The filter uses all that is available, and follows the flight."""
    model, errors = alone(drivers, tmp_path)
    assert model.problems == set()
    # Two seconds without attitude, rate x, height and vertical speed each, and one without all.
    assert all(3900 < count < 4000 for count in model.used.values()) and len(model.used) == 4
    assert errors.height[SETTLED].max() < 0.1 and errors.climb[SETTLED].max() < 0.3
    assert errors.angle[SETTLED].max() < 0.01 and errors.place[SETTLED].max() < 10.0
    # Without height, vertical speed and attitude still bound the error.
    assert errors.height[20:22].max() < 1.0 and errors.climb[20:22].max() < 1.0


def test_the_vehicle_must_stay_above_the_origin(drivers, tmp_path):
    """Else the vertical speed is wrong, because the filter adds position times rate to it."""
    config = parameters('ekf')['pose0_config']
    _, errors = alone(drivers, tmp_path, pose0_config=[False, False, *config[2:]],
                      process_noise_covariance=[0.1] * SIZE)
    assert errors.climb[SETTLED].max() > 3.0 and errors.place.max() > 50.0


@pytest.mark.parametrize('incomplete, poisoned', [('nan', True), ('', False)])
def test_a_start_without_one_axis(drivers, tmp_path, incomplete, poisoned):
    """By default, a NaN would become the state for good; the launch file prevents it."""
    chunks = flight('0 integrity angular_rate_x unavailable\n 2 integrity all safe', 3.0)
    model, _ = alone(drivers, tmp_path, incomplete, chunks)
    assert np.isnan(model.state).any() == poisoned and bool(model.problems) == poisoned


def test_withhold_would_cost_the_attitude(drivers, tmp_path):
    """While one axis is unavailable, imu/data has a NaN, but not in what is used."""
    chunks = flight('1 integrity angular_rate_x unavailable', 3.0)
    counts = [alone(drivers, tmp_path, incomplete, chunks)[0].used['imu0 orientation']
              for incomplete in ('', 'withhold')]
    assert counts[0] - counts[1] > 190


def gps_odometry(fixes):
    """Return what navsat_transform_node makes of the fixes: none of NO_FIX or NaN."""
    usable = [fix for fix in fixes if fix.status.status >= 0
              and not np.isnan([fix.latitude, fix.longitude, fix.altitude]).any()]
    for fix in usable:
        message = Odometry(header=fix.header)
        message.header.frame_id = 'odom'
        message.pose.pose.position.x = radians(fix.longitude - usable[0].longitude) \
            * cos(radians(usable[0].latitude)) * EARTH_RADIUS
        message.pose.pose.position.y = radians(fix.latitude - usable[0].latitude) * EARTH_RADIUS
        spread = np.zeros((6, 6))
        spread[:3, :3] = np.reshape(fix.position_covariance, (3, 3))
        message.pose.covariance = spread.ravel()
        yield message


def test_with_a_titan_m(drivers, tmp_path):
    """Position and velocity come from it as soon as it has a fix, the rest from the BAHRS."""
    messages, settings = published('bahrs', drivers['bahrs'], flight(), tmp_path)
    titan_messages, titan_settings = published(
        'titan_m', drivers['titan_m'], polled_flight(), tmp_path)
    fixes = [message for _, message in titan_messages['fix']]
    assert fixes[0].status.status < 0 and fixes[-1].header.frame_id == 'titan_m_link'
    given, errors = parameters('ekf_titan_m'), Errors()
    model = Filter(given, static_frames(settings, titan_settings))
    topics = {**{topic: [message for _, message in kept] for topic, kept in messages.items()},
              **{f'titan_m/{topic}': [message for _, message in kept]
                 for topic, kept in titan_messages.items()},
              'odometry/gps': list(gps_odometry(fixes))}
    run(model, [(source, topics[source.topic]) for source in sources(given)], errors)
    assert model.problems == set() and len(model.used) == 5
    settled = [second for second in SETTLED if second > 6]
    assert errors.speed[settled].max() < 1.0 and errors.climb[settled].max() < 0.5
    # While the heading is unavailable, the direction of the motion corrects the yaw.
    assert errors.height[settled].max() < 0.3 and errors.angle[settled].max() < 0.03
