# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tables have the values that a conversion writes into a bag, and need no ROS."""

from array import array
import struct
import sys

from bahrs_driver import read
from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.bag.topics import Topic
from bahrs_driver.convert import raw
from bahrs_driver.errors import CaptureError, ParameterError
from bahrs_driver.ros_layout.layouts import serialize
import pytest
from rosbags.rosbag2 import Reader
from rosbags.typesys import get_typestore, Stores
from support.conversions import flight, ORIGIN, S
from support.emulated import emissions, make_device
from support.in_process import run_bahrs
from support.polled import PolledDevice
from support.shared_files import shared_file
from support.without_ros import run_without_ros

STORE = get_typestore(Stores.ROS2_JAZZY)
MINUTE = 470_000                # bytes of the recording
READ = """
import bahrs_driver
assert 'numpy' not in sys.modules
tables = bahrs_driver.read(sys.argv[1])
print({topic: table.rows for topic, table in tables.items()})
"""


def raw_bag(path, sensor, chunks):
    """Write a bag of the raw bytes of chunks."""
    with BagWriter(path) as bag:
        bag.add_topics([Topic('/raw', 'std_msgs/msg/UInt8MultiArray', ())])
        for chunk in chunks:
            label = ReadMetadata(sensor, 1, 86805, chunk.ros_ns, chunk.raw_ns).to_label()
            data = serialize(raw.message(chunk.data, label))
            bag.write([(chunk.ros_ns, '/raw', data, chunk.ros_ns)])
    return path


def titan_m(path):
    """Write a bag of the raw bytes of a polled Titan-M."""
    polled = PolledDevice()
    polled.run(4.0)
    return raw_bag(path, 'titan_m', [Chunk(data, ORIGIN + round(time * S), round(time * S))
                                     for time, data in polled.chunks])


def bahrs(path):
    """Write a bag of the raw bytes of a BAHRS."""
    return raw_bag(path, 'bahrs', flight(6.0)[0])


def recording(path):
    """Write the first minute of the recording of a real device, without times."""
    path.write_bytes(shared_file('data/bahrs_recording_v2.bin').read_bytes()[:MINUTE])
    return path


def plain(value):
    """Return the fields of a message of rosbags as flat pairs; floats as their bits."""
    for name, item in vars(value).items():
        if name == '__msgtype__' or name.isupper():         # a constant
            continue
        if hasattr(item, '__msgtype__'):
            yield from ((f'{name}.{inner}', found) for inner, found in plain(item))
        elif hasattr(item, 'tolist'):
            yield from ((f'{name}.{index}', bits(found))
                        for index, found in enumerate(item.tolist()))
        elif not isinstance(item, list):
            yield name, bits(item)


def bits(value):
    """Return a value that equals itself even if it is NaN."""
    return struct.pack('d', value) if isinstance(value, float) else value


def bag_rows(folder):
    """Return the flat messages of each topic of a bag, with their log times."""
    with Reader(folder) as reader:
        rows = {connection.topic: [] for connection in reader.connections}
        for connection, time_ns, data in reader.messages():
            message = STORE.deserialize_cdr(data, connection.msgtype)
            rows[connection.topic].append({'time_ns': time_ns, **dict(plain(message))})
    return rows


def table_rows(table):
    """Return the rows of a table."""
    columns = [[bits(value) for value in column.tolist()] for column in table.values()]
    return [dict(zip(table, row)) for row in zip(*columns)]


@pytest.mark.parametrize('make, options, words', [
    (recording, {}, ()),
    (recording, {'start_ns': 1_750_000_000 * S, 'parameters': {'frame_convention': 'ned'}},
     ('--start', '1750000000', '-p', 'frame_convention:=ned')),
    (bahrs, {'parameters': {'time.source': 'arrival'}}, ('-p', 'time.source:=arrival')),
    (titan_m, {'parameters': {'gps.week': 2290}}, ('-p', 'gps.week:=2290')),
])
def test_the_same_as_in_a_bag(tmp_path, make, options, words):
    """Topics, order, log times, stamps and all numbers."""
    source = make(tmp_path / 'source')
    status, _, error = run_bahrs('convert', source, tmp_path / 'out', *words)
    tables, expected = read(source, **options), bag_rows(tmp_path / 'out')
    assert (status, error) == (0, ''.join(f'bahrs convert: {note}\n' for note in tables.notes))
    expected.pop('/raw', None)
    assert {f"/{topic.strip('/')}" for topic in tables} == set(expected)
    for topic, table in tables.items():
        rows = expected[f"/{topic.strip('/')}"]
        # Sequences, which are JSON texts, are compared with CSV files elsewhere.
        names = list(rows[0]) if rows else []
        assert [{name: row[name] for name in names} for row in table_rows(table)] == rows
    assert sum(table.rows for table in tables.values()) > 1500


def test_types_and_units(tmp_path):
    """Of the recording of a real device."""
    table = read(recording(tmp_path / 'flight.bin'))['imu/data_raw']
    assert table.message_type == 'sensor_msgs/msg/Imu'
    assert table['time_ns'].dtype == 'int64' and table['angular_velocity.x'].dtype == 'float64'
    assert table.units['linear_acceleration.z'] == 'm/s^2'
    assert table.stack('linear_acceleration').mean(axis=0) == pytest.approx(
        [-0.06, 0.04, 9.75], abs=0.05)
    assert set(table['header.frame_id']) == {'imu_link'}


@pytest.mark.parametrize('make', [recording, bahrs, titan_m])
def test_no_ros_is_imported(tmp_path, make):
    """Importing the package imports no numpy either."""
    source = make(tmp_path / 'source')
    expected = {topic: table.rows for topic, table in read(source).items()}
    assert run_without_ros(READ, source).strip() == str(expected)


def test_damage_is_noted(tmp_path):
    """So are parameters without effect."""
    source = bahrs(tmp_path / 'source')
    (file,) = source.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-2000])
    notes = read(source, parameters={'port': '/dev/x'}).notes
    assert notes[0] == 'settings without effect: port (it is for a port)'
    assert any('its end is missing' in note or 'damaged' in note for note in notes[1:]), notes


@pytest.mark.parametrize('options, error, sentence', [
    ({'sensor': 'gyro'}, ValueError, "sensor is 'gyro': it must be one of bahrs, titan_m"),
    ({'sensor': 'titan_m'}, CaptureError, 'answers of a titan_m have no times'),
    ({'parameters': {'sensor': 'bahrs'}}, ParameterError, 'use the argument sensor'),
    ({'parameters': {'frame_idd': 'x'}}, ParameterError, 'did you mean frame_id?'),
    ({'parameters': {'frame_convention': 'nwu'}}, ParameterError, "must be 'enu' or 'ned'"),
])
def test_wrong_arguments(tmp_path, options, error, sentence):
    """Each is one sentence."""
    path = tmp_path / 'flight.bin'
    path.write_bytes(b''.join(item.data for item in emissions(make_device(), 1.0)))
    with pytest.raises(error) as caught:
        read(path, **options)
    assert sentence in str(caught.value)


def test_unreadable_files(tmp_path, monkeypatch):
    """Missing, without frames, and a bag without the packages that read it."""
    (tmp_path / 'noise').write_bytes(array('H', range(5000)).tobytes())
    for name, sentence in (('absent', 'No such file'), ('noise', 'no frame of a bahrs in')):
        with pytest.raises(CaptureError, match=sentence):
            read(tmp_path / name)
    bag = bahrs(tmp_path / 'bag')
    for module in ('bag_capture', 'bag_files', 'mcap_input'):
        monkeypatch.delitem(sys.modules, f'bahrs_driver.bag.{module}', raising=False)
    monkeypatch.setitem(sys.modules, 'mcap.records', None)
    with pytest.raises(CaptureError, match='mcap.* is missing: install mcap'):
        read(bag)
