# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of reading bags that are compressed, damaged in parts, or have wrong lengths."""

import os
import shutil
import sqlite3
import struct
import subprocess

from bahrs_driver.bag import bag_files, sqlite_input
from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.bag.stored_message import LARGEST_PART
from bahrs_driver.errors import CaptureError
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Chunk as McapChunk
from mcap.writer import CompressionType, MCAP0_MAGIC
import pytest
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from std_msgs.msg import UInt8MultiArray
from support.bags import CHUNKS, every_form, messages, STORE, TYPE, write_bag, write_mcap
from support.processes import command
from support.shared_files import shared_file
import zstandard

BOMB = 1 << 30              # bytes that a few kilobytes expand to
MOST_MEMORY = 2 << 30       # bytes of address space; a process that reads a bag has about one


def test_every_form_of_a_bag(tmp_path):
    """Both storages are read, with all compressions, from a file or a directory."""
    files = every_form(tmp_path)
    assert len(files) == 10
    for file in files:
        read = open_capture(file)
        assert list(read.chunks()) == list(read.chunks()) == CHUNKS, file
        assert (read.done, read.notes, read.sensor) == (read.size, [], 'bahrs')
        assert file.parent == tmp_path or list(open_capture(file.parent).chunks()) == CHUNKS


def test_a_bag_with_another_suffix(tmp_path):
    """Its first bytes show its kind."""
    for file in every_form(tmp_path):
        assert list(open_capture(file.rename(tmp_path / 'flight.bin')).chunks()) == CHUNKS


def test_a_file_beside_its_unfinished_compressed_copy(tmp_path):
    """The uncompressed file is read."""
    folder = write_bag(tmp_path / 'bag', StoragePlugin.MCAP)
    (folder / 'bag.mcap.zstd').write_bytes(zstandard.compress(b'half')[:-1])
    assert list(open_capture(folder).chunks()) == CHUNKS


def test_sqlite_is_read_in_the_order_of_writing(tmp_path):
    """Log times go back where the clock was set."""
    items = [(10 ** 18 - index, data) for index, (_, data) in enumerate(messages())]
    bag = write_bag(tmp_path / 'bag', StoragePlugin.SQLITE3, items=items)
    assert list(open_capture(bag).chunks()) == CHUNKS


def test_sqlite_of_a_recorder_that_was_killed(tmp_path):
    """Messages in its write-ahead log are read; no log is created for a bag without one."""
    bag = write_bag(tmp_path / 'bag', StoragePlugin.SQLITE3, items=messages()[:4])
    assert len(list(open_capture(bag).chunks())) == 4
    assert {file.name for file in bag.iterdir()} == {'bag.db3', 'metadata.yaml'}
    connection = sqlite3.connect(bag / 'bag.db3')
    connection.execute('PRAGMA journal_mode=WAL')
    connection.executemany('INSERT INTO messages (topic_id, timestamp, data) VALUES (2, ?, ?)',
                           [(time, data) for time, data in messages()[4:]])
    connection.commit()
    killed = shutil.copytree(bag, tmp_path / 'killed')
    connection.close()
    assert (killed / 'bag.db3-wal').exists()
    assert list(open_capture(killed).chunks()) == CHUNKS


@pytest.mark.parametrize('name, reason', [
    ('msg_empty', 'it is empty'), ('msg_short', 'it is cut')])
def test_a_message_that_cannot_be_decoded(name, reason):
    """If it is the only message, the error has the reason."""
    with pytest.raises(CaptureError, match=f'no message on topic raw that can be .*{reason}'):
        open_capture(shared_file(f'cases/{name}.mcap'))


@pytest.mark.parametrize('plugin', StoragePlugin)
@pytest.mark.parametrize('bad', [b'', b'\0\1\0\0', b'\0\1', b'\xff' * 40, b'\x28\xb5\x2f\xfdxxxx',
                                 b'\0\1\0\0' + b'\xff' * 8])
def test_bad_messages_among_good_ones(tmp_path, plugin, bad):
    """The good messages are read, and a note has the number of bad ones."""
    items = messages()
    for place in (10, 5, 0):
        items.insert(place, (10 ** 18 + 1000 + place, bad))
    read = open_capture(write_bag(tmp_path / 'bag', plugin, items=items))
    assert list(read.chunks()) == CHUNKS
    assert len(read.notes) == 1 and '3 messages left out as damaged (it ' in read.notes[0]


def test_times_outside_the_range_of_ros(tmp_path):
    """Their messages are left out with a note."""
    path = tmp_path / 'bag'
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/raw', TYPE, typestore=STORE)
        plain = serialize_message(UInt8MultiArray())
        for time in (5, 2 ** 31 * 10 ** 9, 2 ** 63 - 1):
            writer.write(connection, time, plain)
    read = open_capture(path)
    assert [chunk.ros_ns for chunk in read.chunks()] == [5]
    assert '2 messages left out' in read.notes[0] and '2038' in read.notes[0]


def test_a_damaged_chunk(tmp_path):
    """Only its messages are lost, even if it is the first chunk, which has the definitions."""
    file = tmp_path / 'bag.mcap'
    end = write_mcap(file, CompressionType.NONE)
    content = file.read_bytes()
    for label in (b'opening=1 byte_ns=86805 ros_ns=1000000000000000000 ', b'raw_ns=5000000004'):
        place = content.index(label)
        file.write_bytes(content[:place] + b'X' + content[place + 1:])
        read = open_capture(file)
        assert len(list(read.chunks())) == 9
        assert read.notes == [f'{file}: 1 chunk left out as damaged (its checksum is wrong)']
    assert end < len(content)


def bomb(tmp_path, name):
    """Return a small file that claims, or expands to, gigabytes."""
    if name == 'record':
        return shared_file('cases/reclen3g.mcap')
    file = tmp_path / f'{name}.mcap'
    zeros = zstandard.ZstdCompressor().compressobj()
    squeezed = b''.join([*(zeros.compress(bytes(1 << 20)) for _ in range(BOMB >> 20)),
                         zeros.flush()])
    if name == 'file':
        file.write_bytes(squeezed)
        return file
    if name == 'message':
        write_mcap(file, CompressionType.NONE, items=[(1, squeezed)])
        return file
    claims = {'claim': 3 << 30, 'small_claim': 1000, 'limit_claim': LARGEST_PART}
    builder = RecordBuilder()
    McapChunk('zstd', squeezed, 1, 1, 0, claims[name]).write(builder)
    file.write_bytes(MCAP0_MAGIC + builder.end())
    return file


@pytest.mark.parametrize('name', [
    'record', 'file', 'message', 'claim', 'small_claim', 'limit_claim'])
def test_claims_of_gigabytes(tmp_path, name):
    """They are rejected in one sentence, and no such memory is allocated."""
    file = bomb(tmp_path, name)
    done = subprocess.run(
        ['sh', '-c', f'ulimit -v {MOST_MEMORY >> 10}; exec "$0" "$@"',
         *command('bahrs', 'report', str(file))], capture_output=True, text=True,
        env={**os.environ, 'OPENBLAS_NUM_THREADS': '1'}, check=False)
    assert done.returncode == 1 and done.stdout == ''
    assert done.stderr.startswith(f'bahrs report: {file}') and done.stderr.count('\n') == 1


def test_sqlite_message_that_is_too_large(tmp_path, monkeypatch):
    """It is left out with a note, and the others are read."""
    longest = max(len(data) for _, data in messages())
    items = [*messages(), (10 ** 18, bytes(longest + 1))]
    bag = write_bag(tmp_path / 'bag', StoragePlugin.SQLITE3, items=items)
    monkeypatch.setattr(sqlite_input, 'LARGEST_PART', longest)
    read = open_capture(bag)
    assert list(read.chunks()) == CHUNKS and '1 message left out' in read.notes[0]


def test_a_compressed_database_that_expands_too_far(tmp_path, monkeypatch):
    """The error names the command that decompresses it, and no temporary file remains."""
    bag = write_bag(tmp_path / 'bag', StoragePlugin.SQLITE3, compression=CompressionMode.FILE)
    monkeypatch.setattr(bag_files, 'MIN_LIMIT', 1000)
    monkeypatch.setattr(bag_files, 'MAX_RATIO', 2)
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
    with pytest.raises(CaptureError, match='expands to more than .*zstd -d'):
        open_capture(bag)
    assert [file.name for file in tmp_path.iterdir()] == ['bag']


def test_a_database_whose_messages_are_computed(tmp_path):
    """A view, which may never end, is not accepted as a table."""
    file = tmp_path / 'bag.db3'
    with sqlite3.connect(file) as connection:
        connection.execute('CREATE TABLE topics (id, name, type)')
        connection.execute(
            'CREATE VIEW messages AS WITH RECURSIVE n(id) AS (SELECT 1 UNION ALL '
            'SELECT id + 1 FROM n) SELECT id, 1 AS topic_id, 1 AS timestamp, NULL AS data FROM n')
    with pytest.raises(CaptureError, match='has no tables of a bag'):
        open_capture(file)


def test_topics_are_printable(tmp_path):
    """Control characters in their names are escaped."""
    bag = write_bag(tmp_path / 'bag', StoragePlugin.MCAP, ('/\x1bc/raw', '/two/raw'))
    with pytest.raises(CaptureError) as caught:
        open_capture(bag, '/none')
    assert r'/\x1bc/raw' in str(caught.value)
    read = open_capture(bag, '/two/raw')
    assert list(read.chunks()) == CHUNKS and str(read.notes[0]).isprintable()


@pytest.mark.parametrize('claim', [2 ** 63 - 1, 2 ** 64 - 1, 2 ** 62, 3 << 30])
@pytest.mark.parametrize('kind', [Opcode.CHUNK, Opcode.MESSAGE, Opcode.ATTACHMENT, 0x90])
def test_lengths_beyond_the_file(tmp_path, claim, kind):
    """The messages before are read, and a note reports the early end."""
    file = tmp_path / 'bag.mcap'
    end = write_mcap(file)
    file.write_bytes(file.read_bytes()[:end] + struct.pack('<BQ', kind, claim))
    read = open_capture(file)
    assert len(list(read.chunks())) in (9, 10) and 'ends early' in read.notes[-1]
