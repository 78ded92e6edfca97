# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs convert`."""

from collections import defaultdict
import csv
import json
import os
import sys

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.bag.topics import Topic
from bahrs_driver.convert import raw
from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.ros_layout.layouts import serialize
from bahrs_driver.tables.table_files import SINKS
from bahrs_driver.virtual_serial.pty_port import PtyPort
from mcap.reader import make_reader
import pytest
from rosbags.rosbag2 import Reader, StoragePlugin
from rosbags.typesys import get_typestore, Stores
from support.bags import write_bag
from support.devices import DEEP, Device
from support.emulated import emissions, make_device
from support.in_process import run_bahrs
from support.processes import driver, running, wait_for
from support.without_ros import run_without_ros

LONG = 60.0
S = 1_000_000_000
HOUR = 3600 * S
STORE = get_typestore(Stores.ROS2_JAZZY)
NEAR = 10 * S    # ns; a live stamp is what was known then, on a busy machine


def convert(*words):
    """Run the verb in this process; return its exit status and output."""
    status, out, error = run_bahrs('convert', *words)
    return status, error + out


def read(folder):
    """Return the messages of a bag by topic, read equally by rosbags and the MCAP library."""
    found, by_mcap = defaultdict(list), defaultdict(list)
    with Reader(folder) as reader:
        topics = {connection.topic: connection.msgtype for connection in reader.connections}
        for connection, time, data in reader.messages():
            found[connection.topic].append((time, bytes(data)))
    for file in folder.glob('*.mcap'):
        with file.open('rb') as stream:
            for _, channel, message in make_reader(stream).iter_messages():
                by_mcap[channel.topic].append((message.log_time, message.data))
    assert found == by_mcap
    return topics, found


def decoded(topics, topic, items):
    """Return stamps in ns, or None, and the messages without them."""
    stamps, messages = [], []
    for _, data in items:
        message = STORE.deserialize_cdr(data, topics[topic])
        stamp = None
        if hasattr(message, 'header'):
            stamp = message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec
            object.__setattr__(message.header, 'stamp', None)
        stamps.append(stamp)
        messages.append(repr(message))
    return stamps, messages


def listened(folder):
    """Return whether a bag that is being written has all topics and a message."""
    try:
        with Reader(folder) as reader:
            names = {connection.topic for connection in reader.connections}
            return {f'/{topic}' for topic in (*TOPICS, 'raw')} <= names and reader.message_count
    except Exception:           # whatever half a bag may be taken for
        return False


@pytest.fixture
def byte_file(tmp_path):
    """Return a file with five seconds of a stream."""
    file = tmp_path / 'flight.bin'
    file.write_bytes(b''.join(item.data for item in emissions(make_device(), 5.0)))
    return file


def test_topics_of_the_node_are_regenerated(tmp_path):
    """All topics have the same messages, with nearly equal stamps."""
    live, made = tmp_path / 'live', tmp_path / 'made'
    with PtyPort() as port, driver(port.path, publish__raw=True, **DEEP), running(
            'bahrs', 'record', '-o', str(live)) as recorder:
        # Data begins when the recorder listens to all topics, as its first message shows.
        assert wait_for(lambda: listened(live), LONG)
        with Device(port):
            assert wait_for(lambda: sum(
                file.stat().st_size for file in live.glob('*.mcap')) > 80_000, LONG)
        assert recorder.end() == 0
    assert convert(live, made)[0] == 0
    (topics, before), (made_topics, after) = read(live), read(made)
    assert set(topics) - set(made_topics) == {'/rosout'}
    for topic in TOPICS:
        topic = f'/{topic}'
        assert topics[topic] == made_topics[topic]
        stamps, messages = decoded(topics, topic, before[topic])
        new_stamps, new_messages = decoded(topics, topic, after[topic])
        # The recorder may have come to this topic later than to raw, or earlier.
        skip = next(index for index, message in enumerate(messages) if message in new_messages)
        begin = new_messages.index(messages[skip])
        theirs, ours = messages[skip:], new_messages[begin:]
        count = min(len(ours), len(theirs))
        assert ours[:count] == theirs[:count]
        # Of few messages, one may have come before the first sample.
        assert count and len(messages) - count <= max(1, 0.2 * len(messages))
        if stamps[skip] is not None:
            assert all(abs(new - old) < NEAR
                       for old, new in zip(stamps[skip:], new_stamps[begin:]))


def test_two_conversions_are_identical(byte_file, tmp_path):
    """All bytes are equal, and the JSON object has the counts."""
    for parent in ('one', 'two'):
        status, text = convert(byte_file, tmp_path / parent / 'bag', '--json')
        assert status == 0
    result = json.loads(text.splitlines()[-1])
    assert result['frames'] > 1300 and result['skipped_bytes'] == 0
    _, found = read(tmp_path / 'one' / 'bag')
    assert result['messages'] == sum(map(len, found.values()))
    for name in ('bag_0.mcap', 'metadata.yaml'):
        assert (tmp_path / 'one' / 'bag' / name).read_bytes() == (
            tmp_path / 'two' / 'bag' / name).read_bytes()


def test_csv_files(byte_file, tmp_path):
    """There is one file per topic, one column per field, and one row per message."""
    status, _ = convert(byte_file, tmp_path / 'csv', '--as', 'csv', '--start',
                        '2026-05-01T12:00:00Z', '-p', 'frame_convention:=ned')
    assert status == 0
    assert {file.stem for file in (tmp_path / 'csv').iterdir()} == {
        'diagnostics', 'nvm_page', *(topic.replace('/', '_') for topic in TOPICS)}
    with (tmp_path / 'csv' / 'imu_data_raw.csv').open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 800
    assert float(rows[100]['linear_acceleration.z']) == pytest.approx(-9.8, abs=0.1)
    stamp = int(rows[100]['header.stamp.sec']) * 10 ** 9 + int(rows[100]['header.stamp.nanosec'])
    assert int(rows[100]['time_ns']) == stamp
    assert rows[0]['header.stamp.sec'] == '1777636800'
    with (tmp_path / 'csv' / 'integrity.csv').open() as file:
        states = json.loads(next(csv.DictReader(file))['status'])
    assert states[0]['message'] == 'safe'


@pytest.mark.parametrize('kind', ['bag', *SINKS])
def test_no_ros_is_needed(byte_file, tmp_path, kind):
    """Only the check of a namespace uses it."""
    code = 'from bahrs_driver.cli.main import main; sys.exit(main(sys.argv[1:]))'
    run_without_ros(code, 'convert', byte_file, tmp_path / 'without', '--as', kind)
    assert convert(byte_file, tmp_path / 'with', '--as', kind)[0] == 0
    for folder in ('with', 'without'):
        (tmp_path / folder / 'metadata.yaml').unlink(missing_ok=True)       # has the name
    assert [path.read_bytes() for path in sorted((tmp_path / 'with').iterdir())] == [
        path.read_bytes() for path in sorted((tmp_path / 'without').iterdir())]


@pytest.mark.parametrize('missing, words, sentence', [
    ('rosbags', ['--as', 'bag'], 'the Python package rosbags is not installed: pip install mcap'),
    ('pyarrow', ['--as', 'parquet'], 'package pyarrow is not installed: pip install pyarrow\n'),
    ('rclpy.exceptions', ['--namespace', 'left'], 'cannot check --namespace: the Python module'),
])
def test_missing_packages(byte_file, tmp_path, monkeypatch, missing, words, sentence):
    """The sentence names the package, and what to do; no output remains."""
    for name in list(sys.modules):
        if name.startswith((missing, 'bahrs_driver.reprocess.bag_topic_writer',
                            'bahrs_driver.bag.topics', 'bahrs_driver.bag.bag_writer',
                            'bahrs_driver.cli.node_options')):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    status, text = convert(byte_file, tmp_path / 'out', *words)
    assert status == 1 and sentence in text and text.count('\n') == 1
    assert list(tmp_path.iterdir()) == [byte_file]


@pytest.mark.parametrize('plugin', StoragePlugin)
def test_a_clock_that_was_set_back_while_recording(tmp_path, plugin):
    """Order and spacing are kept, and the step is reported as text and JSON."""
    items, begin = [], 1_700_000_000 * S
    for index, emission in enumerate(emissions(make_device(), 5.0)):
        at = round(emission.time * S)
        metadata = ReadMetadata('bahrs', 1, 86805, begin + at - HOUR * (at > 2 * S), 7 * S + at)
        message = raw.message(emission.data, metadata.to_label())
        items.append((metadata.ros_ns, serialize(message)))
    bag = write_bag(tmp_path / 'bag', plugin, items=items)
    status, text = convert(bag, tmp_path / 'out', '--json')
    assert status == 0
    result = json.loads(text.splitlines()[-1])
    sentence = "the host's clock was set by -3600.00"
    assert f'bahrs convert: {sentence}' in text and sentence in result['clock_steps'][0]
    with (tmp_path / 'out' / 'out_0.mcap').open('rb') as file:
        found = [(channel.topic, message.log_time) for _, channel, message in make_reader(
            file).iter_messages(log_time_order=False)]
    times = [time for _, time in found]
    assert times == sorted(times) and 4 * S < times[-1] - times[0] < 6 * S
    samples = [time for topic, time in found if topic == '/imu/data_raw']
    assert all(abs(later - sooner - S // 200) < 500_000
               for sooner, later in zip(samples, samples[1:]))


def test_namespace(byte_file, tmp_path):
    """It precedes all topics."""
    assert convert(byte_file, tmp_path / 'bag', '--namespace', 'uav1')[0] == 0
    topics, _ = read(tmp_path / 'bag')
    made = (*TOPICS, 'nvm/page')
    assert set(topics) == {'/diagnostics', *(f'/uav1/{topic}' for topic in made)}


@pytest.mark.parametrize('words, status, sentence', [
    (['/nowhere', 'OUT'], 1, 'cannot read /nowhere: No such file'),
    (['NOISE', 'OUT'], 1, 'no frame of a bahrs'),
    (['FILE', 'FILE'], 1, 'exists already'),
    (['FILE', '/proc/x'], 1, 'cannot make'),
    (['FILE', 'OUT', '-p', 'speed:=3'], 1, '-p speed:=3: speed (there is no such parameter)'),
    (['FILE', 'OUT', '-p', 'port'], 1, '-p port: it must be NAME:=VALUE'),
    (['FILE', 'OUT', '-p', 'sensor:=titan_m'], 1, 'choose titan_m as the sensor instead'),
    (['FILE', 'OUT', '-p', 'frame_convention:=nwu'], 1, "must be 'enu' or 'ned'"),
    (['FILE', 'OUT', '-p', 'port:=[a'], 1, "'[a' is not valid YAML"),
    (['FILE', 'OUT', '--namespace', 'a b'], 1, "'a b' is not a namespace"),
    (['FILE', 'OUT', '--start', 'noon'], 2, "'noon' is not a time"),
    (['FILE', 'OUT', '--start', '-5'], 2, 'before 1970'),
])
def test_errors(byte_file, tmp_path, words, status, sentence):
    """Each is one sentence, and no output remains."""
    (tmp_path / 'noise').write_bytes(bytes(range(256)) * 20)
    names = {'FILE': byte_file, 'OUT': tmp_path / 'out', 'NOISE': tmp_path / 'noise'}
    found, text = convert(*(names.get(word, word) for word in words))
    assert found == status and sentence in text
    assert {path.name for path in tmp_path.iterdir()} == {'flight.bin', 'noise'}


def test_options_without_effect_are_listed(byte_file, tmp_path):
    """So are parameters, each with the reason."""
    status, text = convert(byte_file, tmp_path / 'out', '--as', 'csv', '--topic', '/raw',
                           '--namespace', 'left', '-p', 'port:=/dev/x', '-p', 'gps.week:=5')
    assert status == 0
    assert 'bahrs convert: options without effect: --topic (a file of bytes has no topics); ' \
        '--namespace (files are named' in text
    assert 'bahrs convert: settings without effect: gps.week (sensor is bahrs); port (it is for ' \
        'a port)' in text


def test_no_port_is_created(byte_file, tmp_path):
    """The parameter port has no effect, which is reported."""
    status, text = convert(byte_file, tmp_path / 'out', '-p', 'port:=socket://x')
    assert status == 0 and 'settings without effect: port (it is for a port)' in text


def test_request_rates_are_refused_for_a_recording(tmp_path):
    """No recorded answer would match a request."""
    with BagWriter(tmp_path / 'bag') as bag:
        bag.add_topics([Topic('/raw', 'std_msgs/msg/UInt8MultiArray', ())])
        label = ReadMetadata('titan_m', 1, 0, 1, 1).to_label()
        bag.write([(1, '/raw', serialize(raw.message(b'x', label)), 1)])
    status, text = convert(tmp_path / 'bag', tmp_path / 'out', '-p', 'gps.rate:=10')
    assert status == 1 and '-p gps.rate:=10: it must be 0' in text


def test_a_missing_topic(tmp_path):
    """The message names the existing topic."""
    with BagWriter(tmp_path / 'bag') as bag:
        bag.add_topics([Topic('/raw', 'std_msgs/msg/UInt8MultiArray', ())])
        bag.write([(1, '/raw', serialize(raw.message(b'bytes', '')), 1)])
    status, text = convert(tmp_path / 'bag', tmp_path / 'out', '--topic', '/nope')
    assert status == 1
    assert text.endswith('has no topic /nope of type std_msgs/msg/UInt8MultiArray, but /raw\n')


def test_two_conversions_to_one_target(byte_file, tmp_path):
    """One creates it, complete; the other is refused and leaves it unchanged."""
    target, foreign = tmp_path / 'out', tmp_path / '.out.partial'
    foreign.mkdir()
    (foreign / 'precious').touch()
    words = ('bahrs', 'convert', str(byte_file), str(target))
    with running(*words) as one, running(*words) as other:
        statuses = sorted(process.wait(LONG) for process in (one, other))
        assert statuses == [0, 1] and 'Traceback' not in one.text + other.text
        assert 'exists already' in one.text + other.text
    alone = tmp_path / 'alone'
    assert convert(byte_file, alone)[0] == 0 and read(target) == read(alone)
    assert set(tmp_path.iterdir()) == {byte_file, target, alone, foreign}
    assert (foreign / 'precious').exists()


def test_an_interrupted_conversion_leaves_nothing(tmp_path):
    """This holds at any time of the interruption."""
    file = tmp_path / 'flight.bin'
    file.write_bytes(b''.join(item.data for item in emissions(make_device(), 60.0)))
    with running('bahrs', 'convert', str(file), str(tmp_path / 'out')) as process:
        assert wait_for(lambda: list(tmp_path.glob('.bahrs_*/out/*')), LONG)
        assert process.end() == 130 and 'Traceback' not in process.text
    assert list(tmp_path.iterdir()) == [file]


def test_a_pipe_is_refused(tmp_path):
    """The second pass would wait for ever."""
    os.mkfifo(tmp_path / 'pipe')
    for source in (tmp_path / 'pipe', '/dev/zero'):
        status, text = convert(source, tmp_path / 'out')
        assert status == 1 and 'write the bytes into a file first' in text
