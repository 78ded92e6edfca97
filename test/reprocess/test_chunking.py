# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests that messages, except for stamps, do not depend on the sizes of reads."""

from collections import defaultdict
from itertools import cycle
import random

from bahrs_driver.bag.capture import Capture, Chunk
from bahrs_driver.clock import Instant
from bahrs_driver.devices.registry import DEVICES
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, build_frame
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, Inertial, InertialTime, Navigation, NavigationTime, SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.reprocess.conversion import Conversion
from bahrs_driver.ros_layout.message_objects import to_message
from hypothesis import example, given, settings, strategies as st
import pytest
from support.ros_messages import as_messages
from support.settings_examples import settings_of

S = 1_000_000_000
ORIGIN = 1_700_000_000 * S
BYTE_NS, PERIOD_NS = 86_806, 5_000_000
SAMPLES = 260
SETTINGS = settings_of(**{'magnetic_field.dip': 60.0, 'magnetic_field.declination': 3.0})
LONGEST_READ = 4095     # bytes that a terminal of Linux holds
chunkings = st.lists(st.integers(1, LONGEST_READ), min_size=1, max_size=20)


def health(chance, count):
    """Return the integrity of signals, mostly SAFE."""
    return tuple(chance.choice([Integrity.SAFE] * 20 + list(Integrity)) for _ in range(count))


def messages(seed):
    """Yield messages with changing accuracy and integrity, each with its sample."""
    chance = random.Random(seed)

    def vector():
        return chance.uniform(-5, 5), chance.uniform(-5, 5), chance.uniform(-5, 5)

    yield 0, SoftwareVersion('OSS', 1, 2)
    for index in range(SAMPLES):
        turn, time = index // 2, 5000 * (index + 100)
        yield index, Inertial(index % 256, vector(), vector(), health(chance, 6))
        if index % 2 == 0:
            angles = (chance.uniform(0, 1.5) for _ in range(3))
            yield index, Navigation(turn % 256, chance.uniform(0, 900), chance.uniform(-9, 9),
                                    *angles, health(chance, 5))
        if index % 20 == 0:
            yield index, InertialTime(index // 20, (index + 1) % 256, time)
            deviations = (chance.uniform(0.001, 0.5) for _ in range(3))
            yield index, Accuracy(index // 20, *deviations, time)
            yield index, NavigationTime(index // 20, (turn + 1) % 256, time)
        if index % 50 == 7:
            yield index, SyncPulseTime(index // 50, time)


def stream(seed):
    """
    Return the bytes of it, and when each has come over the line, in ns.

    There are noise and unknown frames between some messages.
    """
    chance, codec, data, times, now = random.Random(seed + 1), BahrsCodec(), b'', [], 0
    for index, message in messages(seed):
        piece = codec.encode(message, 3)
        if chance.random() < 0.05:
            piece += chance.choice([chance.randbytes(9), b'NE', piece[:chance.randrange(12)],
                                    build_frame(3, 0xC1, bytes(9), 'word')])
        now = max(now, index * PERIOD_NS)
        for _ in piece:
            now += BYTE_NS
            times.append(now)
        data += piece
    return data, times


DATA, TIMES = stream(3)


def chunks(sizes):
    """Yield chunks, with sizes in a cycle, and the host's raw time of each read."""
    begin = 0
    for size in cycle(sizes):
        end = min(begin + size, len(DATA))
        yield DATA[begin:end], S + TIMES[end - 1]
        if end == len(DATA):
            return
        begin = end


def plain(message):
    """Return the values of a message, except for stamps."""
    message = message.__class__(**{name: getattr(message, name)
                                   for name in message.get_fields_and_field_types()})
    if hasattr(message, 'header'):
        message.header = type(message.header)(frame_id=message.header.frame_id)
    return repr(message)


def live(sizes):
    """Return topics and messages in the order in which the node publishes them."""
    sensor = DEVICES['bahrs'].parts(SETTINGS)
    pipeline = sensor.pipeline()
    pipeline.open(BYTE_NS)
    published = []
    for data, raw in chunks(sizes):
        for message, _, stamp_ns in pipeline.feed(data, Instant(raw, ORIGIN + raw)):
            published += as_messages(sensor.converter.convert(message, stamp_ns))
    return [(topic, plain(message)) for topic, message in published]


class Pieces(Capture):
    """A capture of the stream, cut into chunks."""

    timed = True
    byte_ns = BYTE_NS

    def __init__(self, path, sizes):
        super().__init__(path, 1)
        self._sizes = sizes

    def chunks(self):
        """Return the chunks."""
        return (Chunk(data, ORIGIN + raw, raw) for data, raw in chunks(self._sizes))


class ByTopic:
    """An output that stores the messages of each topic without stamps."""

    def __init__(self):
        self.messages = defaultdict(list)

    def begin(self, topics, latched):
        """Prepare the topics."""

    def prepare(self, messages):
        """Return messages as they are."""
        return messages

    def write(self, messages):
        """Store messages."""
        for _, (topic, values) in messages:
            if topic not in ('raw', '/diagnostics'):    # they are about reads
                self.messages[topic].append(plain(to_message(values)))


def converted(path, sizes):
    """Return the messages of each topic of a converted capture."""
    output = ByTopic()
    Conversion(Pieces(path, sizes), SETTINGS, DEVICES['bahrs']).run(output, lambda what: None)
    return output.messages


@pytest.fixture(scope='module')
def whole():
    """Return the published messages of a stream that is read byte by byte."""
    return live([1])


@pytest.mark.slow
@settings(max_examples=25)
@given(sizes=chunkings)
@example(sizes=[LONGEST_READ])
@example(sizes=[62])
def test_what_the_node_publishes(whole, sizes):
    """The messages of all topics, and their order, do not depend on the reads."""
    assert live(sizes) == whole


def as_received(message):
    """Return a message with the precision of its frame."""
    codec = BahrsCodec()
    return codec.decode(Frame(0, codec.encode(message, 3), 'word'))


def test_each_message_is_converted_as_if_alone(whole):
    """Published messages are those of each message of the device, in their order."""
    sensor = DEVICES['bahrs'].parts(SETTINGS)
    alone = [(topic, plain(message)) for _, sent in messages(3)
             for topic, message in as_messages(sensor.converter.convert(
                 as_received(sent), ORIGIN))]
    # The first time messages may come before their time can be known.
    assert [pair for pair in whole if pair[0] != 'time_reference'] == [
        pair for pair in alone if pair[0] != 'time_reference']


@pytest.mark.slow
def test_what_is_converted(tmp_path):
    """The messages of each topic do not depend on the reads of the recording."""
    expected = converted(tmp_path, [7])
    assert len(expected['imu/data']) == SAMPLES // 2
    for sizes in ([LONGEST_READ], [62], [1, 3000], [24, 3, 111]):
        assert converted(tmp_path, sizes) == expected, sizes
