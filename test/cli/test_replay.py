# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs replay`, as a process."""

import contextlib
import json
import os
import signal
import time

from bahrs_driver.bag.bag_writer import BagWriter
from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.bag.topics import Topic
from bahrs_driver.convert import raw
from bahrs_driver.errors import LinkError
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.ros_layout.layouts import serialize
from bahrs_driver.transport.link import Link
import pytest
from support.processes import running, wait_for

SAFE = (Integrity.SAFE,) * 6
SETTLE = 0.5        # s after the port was opened


def stream(seconds):
    """Return inertial frames at 200 Hz and navigation frames at 100 Hz, with noise between."""
    codec, data = BahrsCodec(), b''
    for index in range(200 * seconds):
        data += codec.encode(Inertial(index % 256, (0.0,) * 3, (0.0,) * 3, SAFE), 2)
        if index % 2 == 0:
            data += codec.encode(
                Navigation(index // 2 % 256, 0.0, 0.0, 0.0, 0.0, 0.0, SAFE[:5]), 2)
        if index % 7 == 0:
            data += b'noise NE'
    return data


@pytest.mark.parametrize('rate', [1, 4])
def test_bytes_arrive_at_the_rate_of_the_device(tmp_path, rate):
    """Two seconds of a stream with noise take two seconds, or a quarter of it."""
    data, file, link = stream(2), tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(data)
    with running('bahrs', 'replay', str(file), '--link', str(link), '--rate', str(rate)) as player:
        assert wait_for(lambda: player.lines)
        assert player.lines[0].strip() == str(link)
        port = Link(str(link), 115200)
        begin = time.monotonic()
        port.connect()
        got = b''
        while len(got) < len(data):
            reading = port.read()
            if reading:
                got += reading.data
        took = time.monotonic() - begin
        port.close()
        assert player.wait() == 0
    assert got == data
    assert took >= SETTLE + 2 / rate - 0.01
    assert not os.path.lexists(link)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_interrupted(tmp_path, number):
    """Ctrl-C or another signal ends the replay and removes the link."""
    file, link = tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(stream(1))
    with running('bahrs', 'replay', str(file), '--link', str(link)) as player:
        assert wait_for(lambda: player.lines)
        assert player.end(number) == 130
        assert 'Traceback' not in player.text
    assert not os.path.lexists(link)


def test_a_link_at_the_path_of_a_file(tmp_path):
    """The link is rejected, and the file stays."""
    file = tmp_path / 'data.bin'
    file.write_bytes(b'x')
    with running('bahrs', 'replay', str(file), '--link', str(file)) as player:
        assert player.wait() == 1
        assert 'exists and is not a symbolic link' in player.text
    assert file.read_bytes() == b'x'


@pytest.mark.parametrize('rate', ['0', '-1', 'fast'])
def test_invalid_rate(rate):
    """The rate must be more than 0."""
    with running('bahrs', 'replay', 'x', '--rate', rate) as player:
        assert player.wait() == 2
        assert '--rate' in player.text and 'Traceback' not in player.text


def write_bag(folder, chunks):
    """Write a bag with raw: bytes, and the seconds of their reads."""
    with BagWriter(folder) as bag:
        bag.add_topics([Topic('/raw', 'std_msgs/msg/UInt8MultiArray', ())])
        for at, data in chunks:
            time_ns = 10 ** 18 + round(at * 1e9)
            metadata = ReadMetadata('bahrs', 1, 86805, time_ns, time_ns)
            message = serialize(raw.message(data, metadata.to_label()))
            bag.write([(time_ns, '/raw', message, time_ns)])


def played(file, link, *words):
    """Return the reads of a replay, in seconds since its start, and its output."""
    with running('bahrs', 'replay', str(file), '--link', str(link), '--json', *words) as player:
        assert wait_for(lambda: player.lines)
        port, reads, begin = Link(str(link), 115200), [], time.monotonic()
        port.connect()
        with contextlib.suppress(LinkError):
            while True:
                reading = port.read()
                if reading:
                    reads.append((time.monotonic() - begin, reading.data))
        port.close()
        assert player.wait() == 0
    assert 'Traceback' not in player.text
    return reads, json.loads(player.lines[-1])


def test_a_bag_is_played_at_its_own_times(tmp_path):
    """The bytes are the same and arrive at their times."""
    chunks = [(0.0, b'abc'), (0.5, b'def'), (1.5, b'ghi')]
    write_bag(tmp_path / 'bag', chunks)
    reads, told = played(tmp_path / 'bag', tmp_path / 'port')
    assert b''.join(data for _, data in reads) == b'abcdefghi'
    for at, data in reads:
        assert at >= SETTLE + max(due for due, sent in chunks if {*sent} & {*data}) - 0.01
    assert told == {'bytes': 9, 'faults': {}, 'notes': []}


def test_a_bag_with_a_step_of_the_host_clock(tmp_path):
    """The steady clock sets the pace, even if the wall clock was set."""
    with BagWriter(tmp_path / 'bag') as bag:
        bag.add_topics([Topic('/raw', 'std_msgs/msg/UInt8MultiArray', ())])
        for at, step, data in ((0.0, 0, b'abc'), (0.5, -3600, b'def'), (1.5, 3600, b'ghi')):
            raw_ns = 7 * 10 ** 9 + round(at * 1e9)
            metadata = ReadMetadata('bahrs', 1, 86805, 10 ** 18 + raw_ns + step * 10 ** 9, raw_ns)
            message = serialize(raw.message(data, metadata.to_label()))
            bag.write([(10 ** 18, '/raw', message, 10 ** 18)])
    reads, told = played(tmp_path / 'bag', tmp_path / 'port')
    due = {**dict.fromkeys(b'def', 0.5), **dict.fromkeys(b'ghi', 1.5)}
    for at, data in reads:
        assert SETTLE + max(due.get(byte, 0.0) for byte in data) - 0.01 <= at < 60
    assert [note[:31] for note in told['notes']] == ["the host's clock was set by -36",
                                                     "the host's clock was set by +72"]


def test_faults_on_request(tmp_path):
    """Half of the frames are lost, the others are intact, and the losses are reported."""
    file, data = tmp_path / 'data.bin', stream(2)
    file.write_bytes(data)
    reads, told = played(file, tmp_path / 'port', '--fault', 'drop_frame=0.5', '--latency-timer',
                         '16')
    got = b''.join(data for _, data in reads)
    count = len(Framer(BahrsFormat()).feed(data))
    assert len(Framer(BahrsFormat()).feed(got)) + told['faults']['drop_frame'] in (
        count, count + 1)       # the noise at the end goes for a frame
    assert 0.3 * count < told['faults']['drop_frame'] < 0.7 * count


@pytest.mark.parametrize('words', [['--fault', 'rust=1'], ['--latency-timer', '0']])
def test_invalid_cable_options(words):
    """The sentence lists the valid faults."""
    with running('bahrs', 'replay', 'x', *words) as player:
        assert player.wait() == 2
        assert words[0] in player.text and 'Traceback' not in player.text


@pytest.mark.parametrize('words, status, sentence', [
    ([], 1, 'is empty: there is nothing to play'),
    (['--loop'], 1, 'is empty: there is nothing to play'),
    (['--settle', '-1'], 2, "a time is '-1': it must be a number"),
])
def test_nothing_to_play(tmp_path, words, status, sentence):
    """The error is printed at once, without waiting for a reader."""
    file = tmp_path / 'empty.bin'
    file.touch()
    with running('bahrs', 'replay', str(file), *words) as replay:
        assert replay.wait(60) == status
        assert sentence in replay.text and 'Traceback' not in replay.text


def read_some(link, count):
    """Open the port, read at least some bytes, and close it."""
    port, got = Link(str(link), 115200), b''
    port.connect()
    while len(got) < count:
        reading = port.read()
        got += reading.data if reading else b''
    port.close()
    return got


def test_a_reader_that_comes_back(tmp_path):
    """Playing pauses without a reader, reports each pause once, and resumes at the same byte."""
    sentence = 'the reader has closed the port'
    data, file, link = stream(2), tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(data)
    with running('bahrs', 'replay', str(file), '--link', str(link), '--reopen-timeout', '60',
                 '--rate', '2') as player:
        assert wait_for(lambda: player.lines)
        first = read_some(link, 5000)
        assert wait_for(lambda: sentence in player.text)
        second = read_some(link, 5000)
        assert wait_for(lambda: player.text.count(sentence) == 2)
        assert player.end() == 130
    assert data.startswith(first)
    # What was written and not read when the port was closed is lost, as on a cable.
    assert len(first) <= data.index(second) < len(first) + 10_000


def test_a_reader_that_does_not_come_back(tmp_path):
    """Without another reader the replay ends, and unread bytes do not count as played."""
    data, file, link = stream(20), tmp_path / 'data.bin', tmp_path / 'port'
    file.write_bytes(data)
    with running('bahrs', 'replay', str(file), '--link', str(link), '--reopen-timeout', '0.5',
                 '--json') as player:
        assert wait_for(lambda: player.lines)
        read_some(link, 1000)
        assert player.wait() == 1
    told = json.loads(player.lines[-1])
    assert 1000 <= told['bytes'] < len(data)
    assert 'the rest was not played' in told['notes'][-1]
    assert 'for 0.5 s until a program opens it again' in player.text
    assert not os.path.lexists(link)
