# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node as a process, a pseudo-terminal as the cable, a subscriber in another process."""

import math
import signal
import subprocess
import sys
from time import time_ns

from bahrs_driver.bag.read_metadata import parse_label
from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.convert.raw import TOPIC
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import ANGLE, HEIGHT, Inertial
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.units import byte_time_ns
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from sensor_msgs.msg import Imu
from std_msgs.msg import UInt8MultiArray
from support.devices import DEEP, Device, DIAGNOSTICS, says, status
from support.processes import driver, listening, PATIENCE, running, wait_for
from support.shared_files import shared_file
from support.starting import start


def test_all_topics_in_another_process(cable):
    """Values, axes, frames and stamps of each."""
    with listening(TOPICS) as ear, driver(cable.path), Device(cable):
        for topic in TOPICS:
            ear.wait(topic)
        ear.wait('imu/data_raw', 200)
        raw, imu = ear.messages['imu/data_raw'][-1], ear.messages['imu/data'][-1]
        assert raw.linear_acceleration.z == pytest.approx(9.8, abs=1e-3)
        assert raw.orientation_covariance[0] == -1
        assert imu.header.frame_id == 'imu_link'
        assert imu.orientation_covariance[0] == pytest.approx(4e-4, rel=0.01)
        turn = round(ear.messages['altitude/pose'][-1].pose.pose.position.z / HEIGHT)
        # The heading of the same moment, which may come before it or after.
        assert wait_for(lambda: any(
            heading.data == pytest.approx(math.degrees(ANGLE * turn), abs=0.002)
            for heading in ear.messages['heading']))
        joined = stamps(ear.messages['imu/data'])
        assert wait_for(lambda: stamps(ear.messages['imu/data_raw'])[-1] >= joined[-1])
        times = stamps(ear.messages['imu/data_raw'])
        assert times == sorted(set(times))
        # Either topic may have been found first.
        assert {time for time in joined if time >= times[0]} <= set(times)


def stamps(messages):
    """Return the stamps of messages in ns."""
    return [message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec
            for message in messages]


def test_topic_is_published_while_it_has_a_subscriber(cable):
    """The others are not even converted; the diagnostics name them."""
    with listening(DIAGNOSTICS) as ear, driver(cable.path), Device(cable):
        assert says(ear, 'Publishing', DiagnosticStatus.OK, 'No topic has a subscriber')
        assert wait_for(lambda: reports_without_growth(ear, 'imu/data') >= 2)
        published = value(ear, 'imu/data')
        with listening({'imu/data_raw': Imu}) as late:
            received = late.wait('imu/data_raw', 100)
            assert says(ear, 'Publishing', DiagnosticStatus.OK, 'Publishing')
            unused = value(ear, 'Without subscriber').split(', ')
            assert 'imu/data_raw' not in unused and 'imu/data' in unused
        # The subscriber receives all messages from its first one on.
        periods = [after - before for before, after in zip(stamps(received), stamps(received)[1:])]
        assert all(period < 9_000_000 for period in periods)
        assert says(ear, 'Publishing', DiagnosticStatus.OK, 'No topic has a subscriber')
        assert int(value(ear, 'imu/data_raw')) >= int(published) + 100
        assert value(ear, 'imu/data') == published


def reports_without_growth(ear, topic):
    """Return how many of the latest reports, once data was published, show the same count."""
    counts = [int(pair.value) for array in ear.messages['/diagnostics'] for item in array.status
              if item.name.endswith('Publishing') for pair in item.values if pair.key == topic]
    return 0 if not counts or not counts[-1] else counts.count(counts[-1])


def value(ear, key):
    """Return a value of the latest status of the task Publishing."""
    return next(pair.value for pair in status(ear, 'Publishing').values if pair.key == key)


def test_raw_has_every_byte_and_when_it_was_read(cable):
    """In order, with labels; only if publish.raw is set."""
    topics = {TOPIC: UInt8MultiArray, 'imu/data_raw': Imu}
    with listening(topics) as ear, driver(cable.path, publish__raw=True, **DEEP), \
            Device(cable):
        # Each topic is found when it is: what counts is what raw itself has brought.
        ear.wait('imu/data_raw')
        assert wait_for(lambda: sum(len(piece.data) for piece in list(ear.messages[TOPIC])) > 4000)
        pieces = list(ear.messages[TOPIC])
    assert all(piece.layout.dim[0].size == len(piece.data) for piece in pieces)
    framer = Framer(BahrsFormat())
    frames = [frame for piece in pieces for frame in framer.feed(piece.data.tobytes())]
    numbers = [message.sequence for message in map(BahrsCodec().decode, frames)
               if isinstance(message, Inertial)]
    assert len(numbers) >= 45
    assert numbers == [(numbers[0] + index) % 256 for index in range(len(numbers))]
    assert framer.counters.skipped_bytes == frames[0].offset
    origins = [parse_label(piece.layout.dim[0].label) for piece in pieces]
    assert {origin[:3] for origin in origins} == {('bahrs', 1, byte_time_ns(115200))}
    times = [(origin.raw_ns, origin.ros_ns) for origin in origins]
    assert times == sorted(times) and times[-1][1] <= time_ns()
    with listening(topics) as ear, driver(cable.path), Device(cable):
        ear.wait('imu/data_raw', 20)
        assert not ear.messages[TOPIC] and not ear.node.count_publishers(TOPIC)


def test_ned_by_parameter(cable):
    """Forward, right, down: gravity's reaction points up, which is negative."""
    with listening(TOPICS) as ear, driver(cable.path, frame_convention='ned', frame_id='frd'), \
            Device(cable):
        imu = ear.wait('imu/data_raw')[-1]
        assert imu.linear_acceleration.z == pytest.approx(-9.8, abs=1e-3)
        assert imu.header.frame_id == 'frd'


def test_signal_ends_it_cleanly(cable):
    """Exit status 0, and only the line that the port is open."""
    for number in (signal.SIGINT, signal.SIGTERM):
        with listening(TOPICS) as ear, driver(cable.path) as node, Device(cable):
            ear.wait('imu/data')
            assert node.end(number) == 0, node.text
            assert len(node.lines) == 1 and f'{cable.path} is open' in node.text


def test_signals_are_heeded_before_anything_large_is_imported():
    """Otherwise Ctrl-C in the first second or two would print a traceback."""
    code = 'import sys, bahrs_driver.node.main; sys.exit("rclpy" in sys.modules)'
    assert subprocess.run([sys.executable, '-c', code]).returncode == 0


@pytest.mark.parametrize('words, sentence', [
    (['-p', 'baud_rate:=fast'], "parameter baud_rate is 'fast': it must be a whole number"),
    (['-p', 'frame_convention:=nwu'], "parameter frame_convention is 'nwu': it must be 'enu'"),
    (['-p', 'stddev.velocity:=-1'], 'parameter stddev.velocity is -1: it must be a decimal'),
    (['-p', 'time.sync_pulse.reference:=not a topic'],
     "parameter time.sync_pulse.reference is 'not a topic': it must be 'ros_clock' or the name"),
    (['-p', 'port:=foo://bar'], "parameter port is 'foo://bar': foo:// is not supported"),
    (['-p', 'port'], '-p port cannot be used: '),
    (['-p', 'port:=[]'], "parameter port is []: it must be a text such as '/dev/ttyUSB0'"),
    (['--params-file', 'nowhere.yaml'], 'parameter file nowhere.yaml cannot be read: No such'),
    (['-p', 'qos_overrides./imu/data.publisher.reliability:=best'],
     "parameter qos_overrides./imu/data.publisher.reliability is 'best': it must be 'reliable'"),
])
def test_a_bad_parameter_ends_the_start_with_one_sentence(monkeypatch, capfd, words, sentence):
    """The exit status is not 0, and there is no traceback."""
    status, lines = start(monkeypatch, capfd, *words)
    assert status == 1
    assert len(lines) == 1 and sentence in lines[0]


def test_words_that_are_no_ros_arguments_are_refused():
    """They would have no effect otherwise."""
    with running('driver_node', '--port', '/dev/ttyUSB0') as node:
        assert node.wait() == 1
        assert "'--port' is not understood" in node.text


def test_an_unknown_parameter_is_told(cable):
    """With the name that was probably meant."""
    with driver(cable.path, baudrate=9600) as node:
        assert wait_for(lambda: 'did you mean baud_rate?' in node.text)


def test_whole_numbers_are_good_for_decimal_ones(cable):
    """YAML reads 1 where the user means 1.0."""
    with listening(TOPICS) as ear, driver(cable.path, stddev__velocity=3), Device(cable):
        assert ear.wait('velocity')[-1].twist.covariance[14] == 9


def test_quality_of_service_can_be_overridden(cable):
    """As in REP-2003: reliable by default, overridable by the user."""
    overrides = {'qos_overrides./imu/data.publisher.reliability': 'best_effort'}
    with listening(TOPICS) as ear, driver(cable.path, **overrides), Device(cable):
        assert wait_for(lambda: all(map(ear.node.count_publishers, ('imu/data', 'imu/data_raw'))))
        info = {topic: ear.node.get_publishers_info_by_topic(topic)[0].qos_profile.reliability.name
                for topic in ('/imu/data', '/imu/data_raw')}
        assert info == {'/imu/data': 'BEST_EFFORT', '/imu/data_raw': 'RELIABLE'}


def test_missing_port_is_told_once_and_found_when_it_comes(tmp_path):
    """The node waits for it; diagnostics have the reason."""
    link = str(tmp_path / 'ttyUSB0')
    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(link) as node:
        assert says(ear, 'Link', DiagnosticStatus.ERROR, 'does not exist: plug the device in')
        seen = len(ear.messages['/diagnostics'])
        ear.wait('/diagnostics', seen + 2)
        with PtyPort(link) as port, Device(port):
            ear.wait('imu/data', 10)
            assert says(ear, 'Link', DiagnosticStatus.OK, 'is open')
        assert sum('does not exist' in line for line in node.lines) == 1


def test_unplugged_and_plugged_again_twenty_times(tmp_path):
    """Under load; the node recovers each time, logs once each time, and does not end."""
    link = str(tmp_path / 'ttyUSB0')
    with listening(TOPICS) as ear, driver(link) as node:
        for time in range(1, 21):
            with PtyPort(link) as port, Device(port):
                assert wait_for(lambda: sum('is open' in line for line in node.lines) == time)
                before = len(ear.messages['imu/data'])
                ear.wait('imu/data', before + 20)
        assert node.alive
        assert wait_for(lambda: sum('is gone' in line for line in node.lines) == 20)
        assert sum('is open' in line for line in node.lines) == 20
        assert 'in use' not in node.text
        assert node.end() == 0
        assert 'Traceback' not in node.text


def test_damaged_frames_are_counted_and_not_logged(cable):
    """One bit in every 50th inertial frame."""
    def damage(data, index):
        if index % 50 == 0 and data[4] == Inertial.TYPE:
            return data[:10] + bytes([data[10] ^ 1]) + data[11:]
        return data

    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(cable.path) as node, \
            Device(cable, change=damage):
        assert says(ear, 'Framing', DiagnosticStatus.WARN, 'damaged frames')
        values = {pair.key: pair.value for pair in status(ear, 'Framing').values}
        assert int(values['CRC failures']) >= 1
        assert values['Protocol version'] == '3' and values['CRC order'] == 'word'
        assert len(node.lines) == 1


@pytest.mark.slow
def test_real_recording_at_real_pace(tmp_path):
    """Every frame arrives, at 200 and 100 Hz, at rest about +9.75 m/s^2 on z."""
    seconds, frame_bytes = 20, 24 * 200 + 24 * 100 + (28 + 20 + 20) * 10
    settled = 2             # s, after which the clock knows how late the first samples came
    part = tmp_path / 'part.bin'
    data = shared_file('data/bahrs_recording_v2.bin').read_bytes()
    part.write_bytes(data[:seconds * frame_bytes])
    link = str(tmp_path / 'port')

    with listening({**TOPICS, **DIAGNOSTICS}) as ear, driver(link, **DEEP):
        # The node has found the ear by then, which asked for diagnostics last.
        ear.wait('/diagnostics')
        with running('bahrs', 'replay', str(part), '--link', link, '--settle', '3') as player:
            assert player.wait(seconds + PATIENCE) == 0
            ear.wait('imu/data_raw', 200 * seconds)
            ear.wait('imu/data', 100 * seconds)
    raw, imu = ear.messages['imu/data_raw'], ear.messages['imu/data']
    assert (len(raw), len(imu)) == (200 * seconds, 100 * seconds)
    for messages, rate in ((raw, 200), (imu, 100)):
        times = stamps(messages[settled * rate:])
        span = (times[-1] - times[0]) * 1e-9
        assert (len(times) - 1) / span == pytest.approx(rate, rel=0.005)
    mean = sum(message.linear_acceleration.z for message in raw) / len(raw)
    assert mean == pytest.approx(9.75, abs=0.05)
    # The heading was never valid: level, nose to the north, and the yaw variance says so.
    last = imu[-1]
    assert last.orientation.w == pytest.approx(math.sqrt(0.5), abs=1e-3)
    assert last.orientation.z == pytest.approx(math.sqrt(0.5), abs=1e-3)
    assert last.orientation_covariance[8] == 1e6
    assert not ear.messages['imu/mag'] and math.isnan(ear.messages['heading'][-1].data)
    assert ear.messages['pressure_altitude'][-1].altitude == pytest.approx(537.5, abs=1)
    assert sum(message.orientation_covariance[0] < 0 for message in imu) == 8
