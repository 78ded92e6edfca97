# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the levels and messages of the tasks."""

import random
from types import SimpleNamespace

from bahrs_driver.devices.registry import recognize
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.integrity_task import IntegrityTask
from bahrs_driver.diagnostics.link_task import LinkTask
from bahrs_driver.diagnostics.publishing_task import PublishingCounters, PublishingTask
from bahrs_driver.diagnostics.sharing_watch import ENOUGH_STOLEN
from bahrs_driver.diagnostics.task import ERROR, OK, STALE, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.pipeline import PipelineCounters
from bahrs_driver.pipeline.pipeline import SAMPLE_SIZE
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import Navigation
from bahrs_driver.protocol.framing import FramingCounters
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.transport.port_reader import LinkCounters
import pytest
from support.tasks import summary_of, values_of

SAFE, RISK = Integrity.SAFE, Integrity.INTEGRITY_RISK
GONE, RESERVED = Integrity.UNAVAILABLE, Integrity.RESERVED
LINK = SimpleNamespace(name='/dev/ttyUSB0', path='/dev/ttyUSB0', is_network=False,
                       baud_rate=115200, stolen=0)
HINT = 'is the device powered?'
NAVIGATION = Navigation(0, 500.0, 0.0, 0.0, 0.0, 0.0, (SAFE,) * 5)


def link_task(link, counters, hint=HINT):
    """Return a task for a link without losses."""
    return LinkTask(link, counters, PipelineCounters(FramingCounters()), 1.0, hint, int)


def link_summary(**counters):
    """Return the summary of a link at time 100 s."""
    return summary_of(link_task(LINK, LinkCounters(**counters)), 100.0)


def test_a_closed_port_reports_the_reason():
    """The reason is the error of the link."""
    assert link_summary(error='/dev/ttyUSB0 is gone') == (ERROR, '/dev/ttyUSB0 is gone')


def test_an_open_port_with_data_is_ok():
    """The last byte arrived 0.5 s ago."""
    assert link_summary(open_since=1.0, last_data=99.5) == (OK, '/dev/ttyUSB0 is open')


@pytest.mark.parametrize('last_data', [None, 50.0, 95.0])
def test_a_silent_port_is_an_error_with_a_hint(last_data):
    """Silence begins when the port is opened, if no byte has arrived since."""
    level, message = link_summary(open_since=95.0, last_data=last_data)
    assert level == ERROR
    assert message == '/dev/ttyUSB0 is open but silent: is the device powered?'


@pytest.mark.parametrize('hint, end', [(HINT, '?'), ('Look', '.'), ('Look.', '')])
def test_a_silent_server_is_still_connected(hint, end):
    """Keep-alive would have detected a lost connection. A full stop ends the hint."""
    link = SimpleNamespace(name='socket://h:1', path='', is_network=True, stolen=0)
    task = link_task(link, LinkCounters(open_since=1.0), hint)
    assert summary_of(task, 100.0).message.endswith(
        f"{hint.rstrip('?')}{end} The connection to the serial server is up.")


def test_another_reader_is_reported_with_the_remedy():
    """Its processes are not visible, but reads repeatedly return no bytes."""
    link = SimpleNamespace(**vars(LINK))
    task = link_task(link, LinkCounters(open_since=1.0, last_data=100.0))
    link.stolen = ENOUGH_STOLEN
    task.check_sharing(100.0)
    assert summary_of(task, 100.0) == (
        ERROR, 'another program is reading /dev/ttyUSB0 and takes bytes from the driver (one of '
               'another user): end it; "fuser -v /dev/ttyUSB0" lists all')


def test_a_port_is_not_silent_right_after_opening():
    """The time-out is 1 s."""
    assert link_summary(open_since=99.5).level == OK


def test_use_of_the_line():
    """With ten bits per byte, 5,760 bytes/s are half of 11,520 bytes/s."""
    counters, stream = LinkCounters(open_since=0.0), PipelineCounters(FramingCounters())
    task = LinkTask(LINK, counters, stream, 1.0, HINT, int)
    values_of(task, 0.0)
    stream.bytes_received = 5760
    values = values_of(task, 1.0)
    assert values['Bytes per second'] == '5760' and values['Use of the line'] == '50%'
    assert values['Open for [s]'] == '1.0'
    counters.open_since = None
    assert values_of(task, 2.0)['Open for [s]'] == 'not open'


def framing_summary(received, frames, failures, skipped, last_bytes=b'\xff' * 99):
    """Return the summary after one second with these counts."""
    counters = PipelineCounters(FramingCounters())
    task = FramingTask(counters, 115200, 'bahrs', lambda: {'CRC order': 'word'},
                       recognize, 0.1)
    summary_of(task, 0.0)
    counters.bytes_received, counters.last_bytes = received, last_bytes
    counters.framing.frames, counters.framing.crc_failures = frames, failures
    counters.framing.skipped_bytes = skipped
    assert values_of(task, 1.0)['CRC failures'] == str(failures)
    return summary_of(task, 1.0)


@pytest.mark.parametrize('received, frames, failures, skipped, level, words', [
    (0, 0, 0, 0, STALE, 'Nothing received'),
    (8000, 345, 0, 0, OK, 'All frames intact'),
    (8000, 340, 1, 24, WARN, 'Just now: damaged frames 1, stray bytes 24'),
    (8000, 345, 0, 3, WARN, 'Just now: damaged frames 0, stray bytes 3'),
    (8000, 240, 105, 2600, ERROR, '30% of the frames are damaged: check cable'),
    (30, 0, 0, 0, STALE, 'Waiting for a whole frame'),
    (8000, 0, 0, 8000, ERROR, 'no frame of a bahrs: is 115200 the baud rate'),
])
def test_framing_messages(received, frames, failures, skipped, level, words):
    """Each state has its own message."""
    summary = framing_summary(received, frames, failures, skipped)
    assert summary.level == level and words in summary.message


def test_text_is_reported_as_another_device():
    """A GNSS receiver sends text."""
    summary = framing_summary(8000, 0, 0, 8000, b'$GPGGA,123519,4807.038,N*47\r\n' * 4)
    assert summary.level == ERROR and 'another device is on this port' in summary.message


def test_integrity_of_a_stale_stream_is_unknown():
    """The last integrity does not matter."""
    task = IntegrityTask({'roll': SAFE}, lambda now: now > 5.0)
    assert summary_of(task, 4.0) == (OK, 'All signals safe')
    assert summary_of(task, 6.0) == (STALE, 'No data from the device')


def test_frames_of_the_other_sensor():
    """The frames identify it."""
    bahrs = BahrsCodec().encode(NAVIGATION, 3)
    counters = PipelineCounters(FramingCounters())
    task = FramingTask(counters, 115200, 'titan_m', dict, recognize, 0.1)
    summary_of(task, 0.0)
    counters.bytes_received, counters.last_bytes = 8000, (bahrs * 12)[-SAMPLE_SIZE:]
    assert summary_of(task, 1.0) == (
        ERROR, 'A bahrs is on this port, not a titan_m: set parameter sensor to bahrs')


def test_a_wrong_device_that_sends_little_is_reported():
    """It sends 70 bytes/s, as a GNSS receiver does. Opening the port again resets the count."""
    counters = PipelineCounters(FramingCounters(), streams=1)
    task = FramingTask(counters, 115200, 'bahrs', dict, recognize, 0.1)
    for second in range(6):
        counters.bytes_received += 70
        counters.last_bytes = b'$GPGGA,123519,4807.038,N*47\r\n'
        summary = summary_of(task, float(second))
    assert summary.level == ERROR and 'another device' in summary.message
    counters.streams, counters.bytes_received = 2, counters.bytes_received + 20
    assert summary_of(task, 6.0) == (STALE, 'Waiting for a whole frame')


def test_damage_near_the_limit_rarely_changes_the_level():
    """Each change of level is published at once."""
    counters = PipelineCounters(FramingCounters())
    task, levels = FramingTask(counters, 115200, 'bahrs', dict, recognize, 0.1), []
    chance = random.Random(3)
    for index in range(9000):
        counters.bytes_received += 24
        if chance.random() < 0.1:
            counters.framing.crc_failures += 1
        else:
            counters.framing.frames += 1
        levels.append(summary_of(task, index / 450).level)
    assert sum(before != after for before, after in zip(levels, levels[1:])) < 10


def test_a_device_of_an_unknown_version():
    """Its frames are intact, but all of unknown type."""
    counters = PipelineCounters(FramingCounters())
    task = FramingTask(counters, 115200, 'bahrs', dict, recognize, 0.1)
    summary_of(task, 0.0)
    counters.bytes_received = 8000
    counters.framing.unknown_types.add('0x01 of version 4', 300)
    level, message = summary_of(task, 1.0)
    assert level == ERROR and 'is the bahrs newer than this driver?' in message


@pytest.mark.parametrize('signals, level, message', [
    ({'roll': None, 'pitch': None}, STALE, 'No data from the device'),
    ({'roll': SAFE, 'pitch': SAFE}, OK, 'All signals safe'),
    ({'roll': SAFE, 'pitch': RISK}, WARN, 'pitch integrity risk'),
    ({'roll': GONE, 'pitch': RISK}, ERROR, 'roll unavailable, pitch integrity risk'),
    ({'roll': RESERVED, 'pitch': SAFE}, ERROR, 'roll reserved'),
    ({'roll': SAFE, 'pitch': None}, OK, 'All signals safe'),
])
def test_integrity_messages(signals, level, message):
    """The worst signal determines the level."""
    assert summary_of(IntegrityTask(signals), 0.0) == (level, message)


def test_publishing_becomes_stale():
    """Earlier messages do not count."""
    counters = PublishingCounters.of_topics(['imu/data', 'integrity'])
    task = PublishingTask(counters, 1.0)
    counters.messages['integrity'] = 1          # that there is no data
    assert summary_of(task, 0.0) == (STALE, 'Nothing published yet')
    counters.messages['imu/data'] = counters.converted = 40
    assert summary_of(task, 0.5) == (OK, 'Publishing')
    assert summary_of(task, 1.0).message == 'Publishing'
    assert summary_of(task, 3.0) == (STALE, 'Nothing published just now')
    assert values_of(task, 3.0)['imu/data'] == '40'


def test_topics_without_subscriber_are_named():
    """They are not published, which is no fault."""
    counters = PublishingCounters({'imu/data': 0, 'heading': 0, 'sync_pulse': 0}, {'heading'}, 1)
    task = PublishingTask(counters, 1.0)
    assert summary_of(task, 0.5) == (OK, 'Publishing')
    assert values_of(task, 0.5)['Without subscriber'] == 'imu/data, sync_pulse'
    counters.in_use = ()
    assert summary_of(task, 0.6) == (OK, 'No topic has a subscriber')
    counters.in_use = {'imu/data', 'heading', 'sync_pulse'}
    assert values_of(task, 0.7)['Without subscriber'] == 'none'


def test_a_fault_of_the_driver_is_shown_for_a_while():
    """The count remains."""
    faults = FaultLog(str, str)
    task = PublishingTask(PublishingCounters({'imu/data': 1}, {'imu/data'}, 1), 1.0, faults)
    assert summary_of(task, 0.0) == (OK, 'Publishing')
    faults.report('publishing imu/data', ValueError('no'))
    assert summary_of(task, 0.5) == (
        WARN, 'Fault of the driver: publishing imu/data failed: ValueError: no')
    assert summary_of(task, 12.0).level == STALE
    assert values_of(task, 12.0)['Faults of the driver'] == '1'


def test_a_window_covers_one_to_two_spans():
    """This holds at any time."""
    count = [0]
    window = Window(lambda: count, 1.0)
    for step in range(1, 100):
        now = step * 0.1
        count[0] += 1
        elapsed, (growth,) = window.growth(now)
        assert growth == round(elapsed / 0.1)
        if now > 1.1:
            assert 0.99 < elapsed < 2.0
