# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs record`, as a process beside a driver."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
import contextlib
import json
import os
import re
import resource
import signal
import time

from bahrs_driver.bag.open_capture import open_capture
from bahrs_driver.cli.record import new_bag
from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.errors import WriteError
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat
from bahrs_driver.protocol.bahrs.messages import FORCE
from bahrs_driver.protocol.framing import Framer
from bahrs_driver.virtual_serial.pty_port import PtyPort
from mcap.reader import make_reader
import pytest
from rosbags.rosbag2 import Reader
from support.devices import DEEP, Device
from support.in_process import run_bahrs
from support.processes import driver, running, wait_for
from support.set_clock import SettableClock
import yaml

LONG = 60.0
EVERYTHING = {*(f'/{topic}' for topic in TOPICS), '/raw', '/diagnostics'}


@pytest.fixture
def flying():
    """Run a driver that publishes all topics, including raw."""
    with PtyPort() as port, driver(port.path, publish__raw=True, **DEEP) as node, Device(port):
        assert wait_for(lambda: 'is open' in node.text, LONG)
        yield


def size(folder):
    """Return the size of a bag in bytes."""
    return sum(file.stat().st_size for file in folder.glob('*.mcap'))


def whole(folder, least):
    """Return whether a bag has this size and messages of all topics."""
    return size(folder) >= least and EVERYTHING <= topics_in(folder)


def topics_in(folder):
    """Return the topics with messages in a bag that may still be written."""
    metadata = folder / 'metadata.yaml'
    if not metadata.exists():
        return set()
    bag = yaml.safe_load(metadata.read_text())['rosbag2_bagfile_information']
    return {topic['topic_metadata']['name'] for topic in bag['topics_with_message_count']
            if topic['message_count']}


def counted(folder):
    """Return the messages by topic, read equally by rosbags and the MCAP library."""
    with Reader(folder) as reader:
        found = Counter(connection.topic for connection, _, _ in reader.messages())
    by_mcap = Counter()
    for file in folder.glob('*.mcap'):
        with file.open('rb') as stream:
            by_mcap.update(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert found == by_mcap
    return found


def unbroken(folder):
    """Return the number of bytes in raw, and assert that there is no gap."""
    framer, chunks = Framer(BahrsFormat()), open_capture(folder).chunks()
    frames = [frame for chunk in chunks for frame in framer.feed(chunk.data)]
    assert framer.counters.skipped_bytes == frames[0].offset
    return framer.received


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_recording(flying, tmp_path, number):
    """All topics are in the bag and in its metadata."""
    bag = tmp_path / 'bag'
    with running('bahrs', 'record', '-o', str(bag), '--json') as recorder:
        assert wait_for(lambda: whole(bag, 60_000), LONG)
        assert recorder.end(number) == 0
    result = json.loads(recorder.lines[-1])
    found = counted(bag)
    assert result['topics'] == {topic: found[topic] for topic in result['topics']}
    assert result['messages'] == sum(found.values())
    assert EVERYTHING <= set(found)
    assert unbroken(bag) > 5000


def test_a_killed_recorder(flying, tmp_path):
    """The written part is a valid bag."""
    bag = tmp_path / 'bag'
    with running('bahrs', 'record', '-o', str(bag), '--max-size', '0.05') as recorder:
        assert wait_for(lambda: (bag / 'bag_1.mcap').exists() and whole(bag, 80_000), LONG)
        # Stopped first, which no write is cut short by, as one may be by what kills.
        os.kill(recorder.pid, signal.SIGSTOP)
        os.waitpid(recorder.pid, os.WUNTRACED)
        assert recorder.end(signal.SIGKILL) == -signal.SIGKILL
    found = counted(bag)
    assert found['/imu/data_raw'] > 100 and found['/integrity']
    assert unbroken(bag) > 5000


def test_raw_only(flying, tmp_path):
    """The bag has no other topic, and the recording ends after its duration."""
    with running('bahrs', 'record', '-o', str(tmp_path / 'bag'), '--raw-only',
                 '--duration', '3') as recorder:
        assert recorder.wait(LONG) == 0, recorder.text
    assert set(counted(tmp_path / 'bag')) == {'/raw'}
    assert unbroken(tmp_path / 'bag') > 500


def test_a_full_disk(flying, tmp_path):
    """The recorder reports it and ends, and the bag has all earlier messages."""
    bag = tmp_path / 'bag'
    with running('bahrs', 'record', '-o', str(bag)) as recorder:
        assert wait_for(lambda: size(bag) > 0, LONG)
        resource.prlimit(recorder.pid, resource.RLIMIT_FSIZE, (300_000, 300_000))
        assert recorder.wait(LONG) == 1
    assert 'recording stopped: cannot write' in recorder.text
    assert 'Traceback' not in recorder.text
    assert counted(bag)['/imu/data_raw'] > 0


@pytest.mark.parametrize('words, sentence', [
    ([], 'there is no driver: start the driver, or name it with --node'),
    (['--node', 'x', '--namespace', 'uav'],
     'there is no node named x in namespace /uav'),
])
def test_nothing_to_record(tmp_path, words, sentence):
    """The error names what is missing."""
    with running('bahrs', 'record', '-o', str(tmp_path / 'bag'), *words) as recorder:
        assert wait_for(lambda: sentence in recorder.text, LONG)
        assert recorder.end() == 1
    assert sentence in recorder.text and 'Traceback' not in recorder.text


@pytest.mark.slow
def test_several_drivers(tmp_path):
    """The recorder lists them unless one is named."""
    with contextlib.ExitStack() as stack:
        for side in ('left', 'right'):
            port = stack.enter_context(PtyPort())
            node = stack.enter_context(running(
                'driver_node', '--ros-args', '-p', f'port:={port.path}', '-r', f'__ns:=/{side}',
                '-r', f'__node:={side}_one'))
            stack.enter_context(Device(port))
            assert wait_for(lambda: 'is open' in node.text, LONG)
        recorders = {}
        for words in (['--node', '/left/left_one'], ['--node', 'left_one'],
                      ['--namespace', 'left']):
            bag = tmp_path / words[1].replace('/', '_')
            recorders[bag] = stack.enter_context(
                running('bahrs', 'record', '-o', str(bag), *words))
        undecided = stack.enter_context(running('bahrs', 'record', '-o', str(tmp_path / 'both')))
        for bag, recorder in recorders.items():
            assert wait_for(lambda: {'/left/imu/data', '/diagnostics'} <= topics_in(bag), LONG), \
                recorder.text
            assert recorder.end() == 0, recorder.text
            assert not any(topic.startswith('/right') for topic in counted(bag))
        assert undecided.wait(LONG) == 1
    assert undecided.text == (
        'bahrs record: /left/left_one and /right/right_one run: choose one with '
        '--node /left/left_one\n')


def test_a_driver_without_raw(tmp_path):
    """The remedy is printed during the recording."""
    with PtyPort() as port, driver(port.path), running(
            'bahrs', 'record', '-o', str(tmp_path / 'bag'), '--raw-only') as recorder:
        assert wait_for(lambda: 'publish.raw:=true' in recorder.text, LONG)
        assert recorder.end() == 1
    assert 'does not publish raw' in recorder.text and 'Traceback' not in recorder.text


def test_invalid_options(tmp_path):
    """Each error is one sentence."""
    for words, sentence in ((['--max-size', '0'], 'not more than 0'),
                            (['--namespace', 'a b'], "'a b' is not a namespace"),
                            (['--node', 'a b'], "'a b' is not the name of a node"),
                            (['-o', str(tmp_path)], 'exists already')):
        status, out, error = run_bahrs('record', *words)
        assert status in (1, 2) and out == '' and sentence in error


def test_a_driver_that_starts_later(tmp_path):
    """Messages before discovery are counted, and the remedy is printed."""
    bag = tmp_path / 'bag'
    with PtyPort() as port, Device(port) as device, running(
            'bahrs', 'record', '-o', str(bag)) as recorder:
        assert wait_for(lambda: 'there is no driver' in recorder.text, LONG)
        # While it is stopped, it cannot discover the driver.
        os.kill(recorder.pid, signal.SIGSTOP)
        with driver(port.path, **DEEP):
            assert wait_for(lambda: len(device.inertial) > 100, LONG)
            os.kill(recorder.pid, signal.SIGCONT)
            assert wait_for(lambda: size(bag) > 60_000, LONG)
            assert recorder.end() == 0
    assert 'startup.wait_for_subscribers' in recorder.text
    missed = int(re.search(r'(\d+) messages were published before the recorder',
                           recorder.text)[1])
    assert missed > 0


def test_a_driver_that_waits_for_the_recorder(tmp_path):
    """Nothing is missed, and the first message of each topic is in the bag."""
    bag = tmp_path / 'bag'
    with PtyPort() as port, Device(port), running(
            'bahrs', 'record', '-o', str(bag), '--json') as recorder:
        with driver(port.path, startup__wait_for_subscribers=60, publish__raw=True, **DEEP):
            assert wait_for(lambda: size(bag) > 60_000, LONG)
            assert recorder.end() == 0
    result = json.loads(recorder.lines[-1])
    assert result['lost'] == 0
    assert set(result['missed_before_discovery']) <= {'/diagnostics', '/rosout'}
    framer, codec = Framer(BahrsFormat()), BahrsCodec()
    first = codec.decode(next(frame for chunk in open_capture(bag).chunks()
                              for frame in framer.feed(chunk.data)))
    # The force along x is the number of the message. Opening the port discards what has come.
    assert round(first.specific_force[0] / FORCE) < 5


@pytest.mark.parametrize('raw_only', [True, False])
def test_a_clock_that_is_set_back(tmp_path, raw_only):
    """Log times continue evenly, the step is reported, and a signal ends the recording."""
    bag, clock = tmp_path / 'bag', SettableClock(tmp_path)
    words = ['--raw-only'] * raw_only
    with PtyPort() as port, Device(port) as device, clock.used(), \
            driver(port.path, publish__raw=True, **DEEP), \
            running('bahrs', 'record', '-o', str(bag), '--json', *words) as recorder:
        assert wait_for(lambda: size(bag) > 5_000, LONG)
        before, sent = size(bag), len(device.inertial)
        clock.set_back(3600.0)
        assert wait_for(lambda: size(bag) > before + 60_000, LONG)
        assert wait_for(lambda: len(device.inertial) > sent + 300, LONG)      # 1.5 s
        assert recorder.end() == 0
    result = json.loads(next(line for line in recorder.lines if line.startswith('{')))
    step, = result['clock_steps']
    assert "the host's clock was set by -3600.0000" in step or 'by -3599.9999' in step
    with (bag / 'bag_0.mcap').open('rb') as file:
        times = [message.log_time for _, channel, message in make_reader(file).iter_messages(
            log_time_order=False) if channel.topic == '/raw']
    assert times == sorted(times)
    assert len(set(times)) > 0.9 * len(times)
    assert 0.5e9 < times[-1] - times[0] < LONG * 1e9


def test_names_of_bags_that_begin_in_the_same_second(tmp_path, monkeypatch):
    """Each name is free, and no bag is overwritten."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(time, 'strftime', lambda form: 'bahrs_now')
    with ThreadPoolExecutor(4) as pool:
        bags = [*pool.map(lambda _: new_bag(None), range(8))]
    for bag in bags:
        bag.close()
    assert {str(bag.folder) for bag in bags} == {
        'bahrs_now', *(f'bahrs_now_{number}' for number in range(2, 9))}
    for folder in tmp_path.iterdir():
        with Reader(folder) as reader:
            assert reader.message_count == 0
    with pytest.raises(WriteError, match='bahrs_now exists already'):
        new_bag('bahrs_now')
