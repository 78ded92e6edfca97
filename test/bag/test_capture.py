# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of reading captures: byte files, MCAP and SQLite bags, complete and damaged."""

from bahrs_driver.bag import capture
from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.bag.read_metadata import parse_label
from bahrs_driver.errors import CaptureError
from mcap.writer import CompressionType
import pytest
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import StoragePlugin, Writer
from std_msgs.msg import UInt8MultiArray
from support.bags import CHUNKS, METADATA, PIECES, STORE, TYPE, write_bag, write_mcap


def test_byte_file(tmp_path, monkeypatch):
    """It is read in pieces without times; a second reading begins at the beginning."""
    monkeypatch.setattr(capture, 'PIECE', 30)
    file = tmp_path / 'flight.bin'
    file.write_bytes(b''.join(PIECES))
    read = open_capture(str(file))
    assert (read.size, read.sensor, read.timed) == (200, None, False)
    for _ in range(2):
        chunks = list(read.chunks())
        assert [len(chunk.data) for chunk in chunks] == [30] * 6 + [20]
        assert b''.join(chunk.data for chunk in chunks) == b''.join(PIECES)
        assert {chunk.ros_ns for chunk in chunks} == {None}
        assert read.done == read.size


@pytest.mark.parametrize('plugin', StoragePlugin)
def test_bag(tmp_path, plugin):
    """The label of each message has the times of the read."""
    read = open_capture(write_bag(tmp_path / 'bag', plugin))
    assert (read.sensor, read.byte_ns, read.timed) == ('bahrs', 86805, True)
    assert list(read.chunks()) == list(read.chunks()) == CHUNKS
    assert read.notes == []
    assert read.done == read.size


def test_one_file_of_a_bag(tmp_path):
    """It is read without its directory."""
    path = write_bag(tmp_path / 'bag', StoragePlugin.MCAP)
    assert list(open_capture(path / 'bag.mcap').chunks()) == CHUNKS


@pytest.mark.parametrize('compression', CompressionType)
def test_compressed_chunks(tmp_path, compression):
    """All compressions of MCAP are read."""
    write_mcap(tmp_path / 'a.mcap', compression)
    assert list(open_capture(tmp_path / 'a.mcap').chunks()) == CHUNKS


def test_a_recorder_was_killed(tmp_path):
    """All complete chunks of the file are read, and a note reports its early end."""
    file = tmp_path / 'bag_0.mcap'
    end = write_mcap(file)
    whole, counts = file.read_bytes(), []
    for length in range(len(whole), 0, -13):
        file.write_bytes(whole[:length])
        try:
            read = open_capture(tmp_path)
        except CaptureError as error:
            assert 'ends early' in str(error) or 'no topic raw' in str(error)
            chunks = []
        else:
            chunks = list(read.chunks())
            assert len(read.notes) == (length < len(whole))
        assert chunks == CHUNKS[:len(chunks)]
        if length >= end:
            assert chunks == CHUNKS
        counts.append(len(chunks))
    assert counts == sorted(counts, reverse=True) and set(counts) == set(range(11))


def test_split_bag_without_metadata(tmp_path):
    """Files are read in the order of their numbers: 10 after 9."""
    for index in (10, 9, 2):
        write_mcap(tmp_path / f'bag_{index}.mcap')
    read = open_capture(tmp_path)
    assert list(read.chunks()) == 3 * CHUNKS
    assert read.size == sum(file.stat().st_size for file in tmp_path.iterdir())


def test_raw_messages_of_another_program(tmp_path):
    """Without a label, the time of the read is the log time."""
    with Writer(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/raw', TYPE, typestore=STORE)
        writer.write(connection, 77, serialize_message(UInt8MultiArray(data=b'abc')))
    read = open_capture(tmp_path / 'bag')
    assert list(read.chunks()) == [Chunk(b'abc', 77)]
    assert (read.sensor, read.byte_ns) == (None, None)


def test_several_topics_of_raw_bytes(tmp_path):
    """The first is read unless the user names one, and a note names the others."""
    path = write_bag(tmp_path / 'bag', StoragePlugin.MCAP, ('/one/raw', '/two/raw'))
    read = open_capture(path)
    assert list(read.chunks()) == CHUNKS
    assert '/two/raw' in read.notes[0]
    assert list(open_capture(path, 'two/raw').chunks()) == CHUNKS


@pytest.mark.parametrize('make, sentence', [
    (lambda path: None, 'cannot read .*bag: No such file'),
    (lambda path: path.mkdir(), 'is not a bag: it has no .mcap'),
    (lambda path: path.with_suffix('.mcap').write_bytes(b'x'), 'No such file'),
])
def test_what_cannot_be_read(tmp_path, make, sentence):
    """A CaptureError has the reason."""
    make(tmp_path / 'bag')
    with pytest.raises(CaptureError, match=sentence):
        open_capture(tmp_path / 'bag')


def test_files_that_are_no_bags(tmp_path):
    """A CaptureError names the file."""
    for suffix in ('.mcap', '.db3'):
        file = tmp_path / f'file{suffix}'
        for content in (b'', b'x', bytes(1000)):
            file.write_bytes(content)
            with pytest.raises(CaptureError, match=str(file)):
                open_capture(file)


def test_bag_without_raw(tmp_path):
    """A CaptureError names the parameter that publishes it."""
    with pytest.raises(CaptureError, match='publish.raw'):
        open_capture(write_bag(tmp_path / 'bag', StoragePlugin.MCAP, ()))


@pytest.mark.parametrize('metadata', METADATA[:3])
def test_label(metadata):
    """Parsing a label returns its metadata; other words in it are ignored."""
    assert parse_label(metadata.to_label()) == metadata
    assert parse_label(metadata.to_label() + ' new=1') == metadata


@pytest.mark.parametrize('label', [
    '', 'rows', 'sensor=x', 'sensor=x opening=y byte_ns=1',
    f'sensor=bahrs opening=1 byte_ns=1 ros_ns={2 ** 63} raw_ns=1',
    'sensor=bahrs opening=1 byte_ns=1 ros_ns=-1 raw_ns=1'])
def test_label_of_another_program(label):
    """Parsing it returns None."""
    assert parse_label(label) is None
