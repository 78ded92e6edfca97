# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of writing bags: for other readers, killed at any time, split, on a full disk."""

import contextlib
import os
from pathlib import Path
import resource
import shutil

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.crash_safe_file import CrashSafeFile
from bahrs_driver.bag.topics import qos_profile, Topic
from bahrs_driver.errors import WriteError
from mcap.reader import make_reader
import pytest
from rclpy.serialization import serialize_message
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2 import Reader
from std_msgs.msg import Float64
import yaml

LATCHED = qos_profile('keep_last', 100, 'reliable', 'transient_local')
TOPICS = [Topic('/heading', 'std_msgs/msg/Float64', (LATCHED,)),
          Topic('/uav/raw', 'std_msgs/msg/UInt8MultiArray', ())]
START = 1_700_000_000_000_000_000


def number(value):
    """Return a serialized Float64."""
    return serialize_message(Float64(data=float(value)))


def heading(index, data):
    """Return what is written of a message with a number."""
    return START + index, '/heading', data, START + index


def written(folder, count=100, topics=TOPICS):
    """Write a bag, and return its messages."""
    with BagWriter(folder) as bag:
        bag.add_topics(topics)
        for index in range(count):
            bag.write([heading(index, number(index))])
    return [('/heading', START + index, number(index)) for index in range(count)]


def with_rosbags(folder):
    """Return the messages that rosbags reads."""
    with Reader(folder) as reader:
        return [(connection.topic, time, bytes(data))
                for connection, time, data in reader.messages()]


def with_mcap(folder):
    """Return the messages that the mcap library reads."""
    found = []
    for file in sorted(folder.glob('*.mcap')):
        with file.open('rb') as stream:
            found += [(channel.topic, message.log_time, message.data)
                      for _, channel, message in make_reader(stream).iter_messages()]
    return found


def information(folder):
    """Return the contents of metadata.yaml."""
    return yaml.safe_load((folder / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def test_other_libraries_read_it(tmp_path):
    """They find messages, definitions, quality of service and metadata."""
    sent = written(tmp_path / 'bag')
    assert with_rosbags(tmp_path / 'bag') == with_mcap(tmp_path / 'bag') == sent
    with Reader(tmp_path / 'bag') as reader:
        assert (reader.message_count, reader.start_time, reader.duration) == (100, START, 100)
        assert reader.ros_distro == 'jazzy'
        heading, raw = reader.connections
        assert (heading.msgcount, raw.msgcount) == (100, 0)
        assert heading.digest.startswith('RIHS01_705ba9c3')
        assert 'float64 data' in heading.msgdef.data
        offered, = heading.ext.offered_qos_profiles
        assert offered.durability is QosDurability.TRANSIENT_LOCAL
        assert offered.reliability is QosReliability.RELIABLE
    with (tmp_path / 'bag' / 'bag_0.mcap').open('rb') as stream:
        summary = make_reader(stream).get_summary()
    assert summary.statistics.message_count == 100
    assert {schema.name: schema.encoding for schema in summary.schemas.values()} == {
        'std_msgs/msg/Float64': 'ros2msg', 'std_msgs/msg/UInt8MultiArray': 'ros2msg'}


def test_same_messages_make_the_same_bytes(tmp_path):
    """Two bags with the same messages are equal."""
    for parent in ('one', 'two'):
        written(tmp_path / parent / 'bag')
    for name in ('bag_0.mcap', 'metadata.yaml'):
        assert (tmp_path / 'one' / 'bag' / name).read_bytes() == (
            tmp_path / 'two' / 'bag' / name).read_bytes()


def test_killed_at_any_time(tmp_path):
    """The files are a bag with all messages up to the last flush."""
    bag, sent = BagWriter(tmp_path / 'bag'), []
    bag.add_topics(TOPICS)
    for index in range(50):
        bag.write([heading(index, number(index))])
        sent.append(('/heading', START + index, number(index)))
        if index % 10 == 9:
            bag.flush()
            if index % 20 == 19:
                bag.sync()
        copy = tmp_path / f'copy{index}'
        shutil.copytree(tmp_path / 'bag', copy)
        kept = sent[:(index + 1) // 10 * 10]
        assert with_mcap(copy) == kept
        assert with_rosbags(copy) == kept
        assert with_rosbags(copy / 'bag_0.mcap') == kept
        assert information(copy)['message_count'] == (index + 1) // 20 * 20
    bag.close()
    assert with_mcap(tmp_path / 'bag') == with_rosbags(tmp_path / 'bag') == sent


def test_a_file_has_its_name_once_it_is_complete(tmp_path):
    """A reader never finds a file of the bag without its trailer."""
    file = CrashSafeFile(tmp_path / 'bag_0.mcap', b'end')
    file.write(b'data')
    assert not list(tmp_path.glob('*.mcap'))
    file.flush()
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {
        'bag_0.mcap': b'dataend'}
    file.close()


def test_a_file_of_another_program_is_not_replaced(tmp_path):
    """A split raises WriteError if a file with the next name exists."""
    bag = BagWriter(tmp_path / 'bag')
    (tmp_path / 'bag' / 'bag_1.mcap').write_text('precious')
    with pytest.raises(WriteError, match='bag_1.mcap exists already'):
        bag.split()
    bag.close()
    assert (tmp_path / 'bag' / 'bag_1.mcap').read_text() == 'precious'


def test_split(tmp_path):
    """Each file has all topics and can be read alone; metadata.yaml lists all files."""
    with BagWriter(tmp_path / 'bag') as bag:
        bag.add_topics(TOPICS)
        for index in range(30):
            bag.write([heading(index, number(index))])
            if index % 10 == 9 and index < 29:
                bag.split()
    assert with_mcap(tmp_path / 'bag') == with_rosbags(tmp_path / 'bag')
    assert len(with_mcap(tmp_path / 'bag')) == 30
    assert information(tmp_path / 'bag')['relative_file_paths'] == [
        'bag_0.mcap', 'bag_1.mcap', 'bag_2.mcap']
    assert [file['starting_time']['nanoseconds_since_epoch'] - START
            for file in information(tmp_path / 'bag')['files']] == [0, 10, 20]


def test_unknown_type(tmp_path):
    """Its topic is written without a definition."""
    written(tmp_path / 'bag', topics=[*TOPICS, Topic('/x', 'their_msgs/msg/Thing', ())])
    assert len(with_mcap(tmp_path / 'bag')) == 100


@contextlib.contextmanager
def small_disk():
    """Limit files to 4,000 bytes, including the output of the tests."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_no_room(tmp_path):
    """A WriteError is raised; all messages up to the last complete flush can be read."""
    bag, sent, good = BagWriter(tmp_path / 'bag'), [], 0
    bag.add_topics(TOPICS)
    with small_disk(), \
            pytest.raises(WriteError, match='bag_0.mcap: File too large: choose another'):
        while True:
            data = number(0.0)[:4] + os.urandom(8)
            bag.write([heading(len(sent), data)])
            sent.append(('/heading', START + len(sent), data))
            if len(sent) % 5 == 0:
                bag.sync()
                bag.flush()
                good = len(sent)
    with small_disk():
        bag.close()
    assert good > 10
    assert with_mcap(tmp_path / 'bag') == with_rosbags(tmp_path / 'bag') == sent[:good]


def test_impossible_targets(tmp_path):
    """An existing directory, and a path in /proc or /dev, raise WriteError."""
    with pytest.raises(WriteError, match='exists already'):
        BagWriter(tmp_path)
    for place in ('/proc/bag', '/dev/bahrs_unplugged'):
        with pytest.raises(WriteError, match=f'cannot (make|write) {place}'):
            BagWriter(Path(place))
        assert not os.path.lexists(place)
