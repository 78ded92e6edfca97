# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Whatever comes from a device, memory and /diagnostics do not grow with it.

Hostile traffic goes through all parts of the driver, as the node puts them together, and what
Python has allocated is measured. It is generated: noise, markers, frames of known and unknown
types with valid checksums and random contents, damaged ones, host clocks that are set, and links
that are lost.
"""

import functools
import gc
import inspect
import random
import tracemalloc

from bahrs_driver.bag.message_queue import MessageQueue, OVERHEAD, RecordedMessage
from bahrs_driver.clock import Instant
from bahrs_driver.devices.registry import recognize
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.diagnostics.updater import Updater
from bahrs_driver.monitor.topic_stats import MAX_ARRIVALS, TopicStats
from bahrs_driver.pipeline import Notice
from bahrs_driver.protocol.bahrs.frames import build_frame
from bahrs_driver.protocol.bahrs.messages import layouts
from bahrs_driver.protocol.titan_m.frames import ANSWER_MARKER, checksum, CHECKSUM_ORDERS
from bahrs_driver.protocol.titan_m.messages import ANSWERS, PAYLOAD_SIZES
from bahrs_driver.transport.channel import Reading
from bahrs_driver.transport.link import Link
import pytest
from support.settings_examples import parts_of

MS, SECOND = 1_000_000, 1_000_000_000
CHUNKS = 900
SETTLED = CHUNKS // 3           # after which everything that is bounded has filled
GROWTH = 256 * 1024             # bytes that allocations may differ by, after that
MOST_TEXT = 20_000              # characters of all values in /diagnostics
FED_BY_THE_WIRE = [['bahrs_driver', name] for name in ('protocol', 'clock', 'convert')]


class Driver:
    """All parts of the driver between bytes and messages, put together as the node does it."""

    def __init__(self, sensor_name):
        self.link = Link('loop://', 115200)
        self.sensor = sensor = parts_of(sensor_name)
        self.live = sensor.live(self.link)
        self.pipeline = sensor.pipeline()
        self.time_task = TimeTask(sensor.clock, sensor.health.stale)
        self.now = 0.0
        self.updater = Updater(
            [FramingTask(self.pipeline.counters, 115200, sensor_name, sensor.protocol,
                         recognize, 0.1),
             self.time_task, *sensor.health.tasks, *self.live.tasks],
            'test', 'port', lambda: self.now)

    def begin(self):
        """Begin a stream."""
        self.pipeline.open(86_806)
        self.sensor.health.restart()

    def lose(self, ros_ns):
        """Lose the link, as the reader and the node do it."""
        self.publish(self.pipeline.close())
        list(self.sensor.converter.end_stream(ros_ns))

    def feed(self, reading):
        """Take what a read has brought."""
        self.now = reading.now.raw_ns / SECOND
        self.publish(self.pipeline.feed(reading.data, reading.now))
        self.time_task.update(self.now)

    def publish(self, events):
        """Make ROS messages of device messages."""
        for event in events:
            if isinstance(event, Notice):
                self.time_task.notice(event.text, self.now)
                continue
            message, frame, stamp_ns = event
            self.sensor.health.observe(message, self.now)
            if self.live.nvm:
                self.live.nvm.receive(message, frame)
            for _ in self.sensor.converter.convert(message, stamp_ns):
                pass

    def diagnostics(self):
        """Return how many characters /diagnostics holds."""
        return sum(len(item.key) + len(item.value) for status in self.updater.statuses()
                   for item in status.values)


def bahrs_bytes(chance):
    """Return some bytes that a hostile BAHRS may send."""
    kind = chance.randrange(6)
    if kind == 0:
        return chance.randbytes(chance.randrange(60))
    if kind == 1:
        return b'NE' * chance.randrange(40)
    if kind == 2:           # of any type and version
        return build_frame(chance.randrange(65536), chance.randrange(256),
                           chance.randbytes(chance.randrange(60)),
                           chance.choice(['word', 'byte', 'crc32']))
    (version, message_type), layout = chance.choice(list(layouts().items()))
    frame = build_frame(version, message_type, chance.randbytes(layout.size), 'word')
    return frame[:chance.randrange(len(frame))] if kind == 3 else frame


def unknown_frames(chance, count):
    """Return intact frames of random types."""
    return b''.join(build_frame(chance.randrange(4, 65536), chance.randrange(256), b'1234', 'byte')
                    for _ in range(count))


def titan_bytes(chance):
    """Return some bytes that a hostile Titan-M may send."""
    kind = chance.randrange(5)
    if kind == 0:
        return chance.randbytes(chance.randrange(60))
    if kind == 1:
        return ANSWER_MARKER * chance.randrange(10)
    answer = chance.choice(ANSWERS)
    size = PAYLOAD_SIZES[answer]
    payload = bytes(size) if kind == 2 else chance.randbytes(size)
    body = ANSWER_MARKER + bytes([chance.choice(answer.LENGTHS), chance.randrange(256)]) + payload
    frame = body + checksum(body, chance.choice(CHECKSUM_ORDERS))
    return frame[:chance.randrange(len(frame))] if kind == 3 else frame


TRAFFIC = {'bahrs': bahrs_bytes, 'titan_m': titan_bytes}


def readings(sensor_name, seed):
    """Yield reads of hostile traffic; None where the link is lost."""
    chance, make = random.Random(seed), TRAFFIC[sensor_name]
    raw, ros = 5 * SECOND, 1_700_000_000 * SECOND
    for index in range(CHUNKS):
        event = chance.random()
        if event < 0.01:
            yield None
        step = chance.choice([0, MS, 16 * MS, 50 * MS])
        if event > 0.995:
            step = 3 * SECOND
        raw, ros = raw + step, ros + step + (event < 0.02) * chance.randint(-SECOND, SECOND)
        data = b''.join(make(chance) for _ in range(chance.randrange(1, 12)))
        if index % (CHUNKS // 6) == 0:
            data += unknown_frames(chance, 2000)
        yield Reading(data, Instant(raw, ros))


@pytest.mark.slow
@pytest.mark.parametrize('sensor_name', TRAFFIC)
def test_hostile_traffic_grows_nothing(sensor_name):
    """Neither what is allocated, once all queues are full, nor what is published of it."""
    driver = Driver(sensor_name)
    driver.begin()
    settled, most, text = 0, 0, 0
    tracemalloc.start()
    try:
        for index, reading in enumerate(readings(sensor_name, 1)):
            if reading is None:
                driver.lose(1_700_000_000 * SECOND)
                driver.begin()
                continue
            driver.feed(reading)
            if index % 50 == 0:
                text = max(text, driver.diagnostics())
                gc.collect()
                used, _ = tracemalloc.get_traced_memory()
                if index <= SETTLED:
                    settled = max(settled, used)
                most = max(most, used)
    finally:
        tracemalloc.stop()
        driver.link.close()
    counters = driver.sensor.framer.counters
    assert counters.frames > CHUNKS
    assert most < settled + GROWTH, f'{settled} bytes became {most}'
    assert text < MOST_TEXT
    assert driver.sensor.framer.pending < 2048
    if sensor_name == 'bahrs':
        assert counters.unknown_types.total() > 10_000 and len(counters.unknown_types) == 33


def test_every_cache_is_bounded():
    """Of functions with arguments: what is decoded comes from the wire."""
    gc.collect()
    caches = [item for item in gc.get_objects() if isinstance(item, functools._lru_cache_wrapper)
              and (getattr(item, '__module__', None) or '').split('.')[:2] in FED_BY_THE_WIRE]
    assert len(caches) > 3
    assert not [cache for cache in caches if cache.cache_parameters()['maxsize'] is None
                and inspect.signature(cache.__wrapped__).parameters]


def test_a_tally_of_many_messages_remembers_few(monkeypatch):
    """And has the right rate all the same."""
    now = [0.0]
    monkeypatch.setattr('bahrs_driver.monitor.topic_stats.time.monotonic', lambda: now[0])
    stats = TopicStats()
    for index in range(4 * MAX_ARRIVALS):
        now[0] = index / 10_000
        stats.add(b'')
    assert len(stats._arrivals) == MAX_ARRIVALS
    assert stats.rate() == pytest.approx(10_000)


def test_a_recorder_whose_disk_is_slow_keeps_so_much_and_counts_the_rest():
    """What was kept comes in order, and then there is room again."""
    queue = MessageQueue(10 * (100 + OVERHEAD))
    for _ in range(2):
        for index in range(25):
            queue.put(RecordedMessage(index, '/topic', bytes(100), index))
        assert [item.log_time for item in queue.take_all()] == list(range(10))
    assert queue.dropped == 30 and queue.take_all() == []
