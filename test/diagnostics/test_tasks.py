# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the messages of each task."""

import random
from types import SimpleNamespace

from bahrs_driver.devices.registry import recognize
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.integrity_task import IntegrityTask
from bahrs_driver.diagnostics.link_task import LinkTask
from bahrs_driver.diagnostics.publishing_task import PublishingTask
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
    """Return the summary on a link at the time 100 s."""
    return summary_of(link_task(LINK, LinkCounters(**counters)), 100.0)


def test_a_port_that_is_not_open_says_why():
    """In the words of the link."""
    assert link_summary(error='/dev/ttyUSB0 is gone') == (ERROR, '/dev/ttyUSB0 is gone')


def test_an_open_port_with_data_is_fine():
    """The last byte came half a second ago."""
    assert link_summary(open_since=1.0, last_data=99.5) == (OK, '/dev/ttyUSB0 is open')


@pytest.mark.parametrize('last_data', [None, 50.0, 95.0])
def test_a_silent_port_is_an_error_that_says_what_to_look_at(last_data):
    """Counted from its opening if nothing ever came, or came before it."""
    level, message = link_summary(open_since=95.0, last_data=last_data)
    assert level == ERROR
    assert message == '/dev/ttyUSB0 is open but silent: is the device powered?'


@pytest.mark.parametrize('hint, end', [(HINT, '?'), ('Look', '.'), ('Look.', '')])
def test_a_silent_server_is_not_the_connection(hint, end):
    """Keep-alive would have reported it; a full stop ends the hint before this sentence."""
    link = SimpleNamespace(name='socket://h:1', path='', is_network=True, stolen=0)
    task = link_task(link, LinkCounters(open_since=1.0), hint)
    assert summary_of(task, 100.0).message.endswith(
        f"{hint.rstrip('?')}{end} The connection to the serial server is up.")


def test_another_program_on_the_port_is_named_with_the_remedy():
    """It cannot be seen, but reads find nothing again and again."""
    link = SimpleNamespace(**vars(LINK))
    task = link_task(link, LinkCounters(open_since=1.0, last_data=100.0))
    link.stolen = ENOUGH_STOLEN
    task.check_sharing(100.0)
    assert summary_of(task, 100.0) == (
        ERROR, 'another program is reading /dev/ttyUSB0 and takes bytes from the driver (one of '
               'another user): end it, "fuser -v /dev/ttyUSB0" lists all')


def test_a_port_just_opened_is_not_yet_silent():
    """It has a second."""
    assert link_summary(open_since=99.5).level == OK


def test_traffic_is_told_against_the_baud_rate():
    """Ten bits a byte: 5,760 of 11,520 bytes a second are half of the line."""
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
    """Return the summary after a second that brought so much."""
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
def test_framing(received, frames, failures, skipped, level, words):
    """Each state has a message of its own."""
    summary = framing_summary(received, frames, failures, skipped)
    assert summary.level == level and words in summary.message


def test_text_is_another_device():
    """Such as a GNSS receiver."""
    summary = framing_summary(8000, 0, 0, 8000, b'$GPGGA,123519,4807.038,N*47\r\n' * 4)
    assert summary.level == ERROR and 'another device is on this port' in summary.message


def test_integrity_of_a_stream_that_ended_is_not_known():
    """However safe it was."""
    task = IntegrityTask({'roll': SAFE}, lambda now: now > 5.0)
    assert summary_of(task, 4.0) == (OK, 'All signals safe')
    assert summary_of(task, 6.0) == (STALE, 'No data from the device')


def test_the_other_sensor_is_named():
    """Its frames are as good a proof as ours."""
    bahrs = BahrsCodec().encode(NAVIGATION, 3)
    counters = PipelineCounters(FramingCounters())
    task = FramingTask(counters, 115200, 'titan_m', dict, recognize, 0.1)
    summary_of(task, 0.0)
    counters.bytes_received, counters.last_bytes = 8000, (bahrs * 12)[-SAMPLE_SIZE:]
    assert summary_of(task, 1.0) == (
        ERROR, 'A bahrs is on this port, not a titan_m: set parameter sensor to it')


def test_a_wrong_device_that_says_little_is_told_as_well():
    """A sentence of 70 bytes a second, as GNSS receivers have it; not after a new opening."""
    counters = PipelineCounters(FramingCounters(), streams=1)
    task = FramingTask(counters, 115200, 'bahrs', dict, recognize, 0.1)
    for second in range(6):
        counters.bytes_received += 70
        counters.last_bytes = b'$GPGGA,123519,4807.038,N*47\r\n'
        summary = summary_of(task, float(second))
    assert summary.level == ERROR and 'another device' in summary.message
    counters.streams, counters.bytes_received = 2, counters.bytes_received + 20
    assert summary_of(task, 6.0) == (STALE, 'Waiting for a whole frame')


def test_a_share_of_damage_at_the_limit_is_not_another_level_at_every_frame():
    """Each change of level is reported at once."""
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


def test_a_device_of_an_unknown_version_is_told():
    """Its frames are intact, and not one of them is understood."""
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
def test_integrity(signals, level, message):
    """The worst signal gives the level."""
    assert summary_of(IntegrityTask(signals), 0.0) == (level, message)


def test_publishing_is_of_the_present():
    """What went out an hour ago is no comfort."""
    counts = {'imu/data': 0, 'integrity': 0}
    task = PublishingTask(counts, 1.0, ('integrity',))
    counts['integrity'] = 1             # that there is no data
    assert summary_of(task, 0.0) == (STALE, 'Nothing published yet')
    counts['imu/data'] = 40
    assert summary_of(task, 0.5) == (OK, 'Publishing')
    assert summary_of(task, 1.0).message == 'Publishing'
    assert summary_of(task, 3.0) == (STALE, 'Nothing published just now')
    assert values_of(task, 3.0)['imu/data'] == '40'


def test_a_fault_of_the_driver_is_shown_for_a_while():
    """And counted for ever."""
    faults = FaultLog(str, str)
    task = PublishingTask({'imu/data': 1}, 1.0, (), faults)
    assert summary_of(task, 0.0) == (OK, 'Publishing')
    faults.report('publishing imu/data', ValueError('no'))
    assert summary_of(task, 0.5) == (
        WARN, 'Fault of the driver: publishing imu/data failed: ValueError: no')
    assert summary_of(task, 12.0).level == STALE
    assert values_of(task, 12.0)['Faults of the driver'] == '1'


def test_a_window_covers_one_span_to_two():
    """Whenever it is asked."""
    count = [0]
    window = Window(lambda: count, 1.0)
    for step in range(1, 100):
        now = step * 0.1
        count[0] += 1
        elapsed, (growth,) = window.growth(now)
        assert growth == round(elapsed / 0.1)
        if now > 1.1:
            assert 0.99 < elapsed < 2.0
