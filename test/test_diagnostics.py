# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what the counters are said to mean."""

from types import SimpleNamespace

from bahrs_driver.diagnostics import ERROR, judge_framing, judge_link, Monitor, OK, WARN
from bahrs_driver.protocol.framing import FramingCounters
from bahrs_driver.receiver import LinkCounters
import pytest


def link_verdict(**counters):
    """Return the verdict on a link at the time 100 s."""
    return judge_link(LinkCounters(**counters), 100.0, '/dev/ttyUSB0')


def test_a_port_that_is_not_open_says_why():
    """In the words of the link."""
    assert link_verdict(error='/dev/ttyUSB0 is gone') == (ERROR, '/dev/ttyUSB0 is gone')


def test_an_open_port_with_data_is_fine():
    """The last byte came half a second ago."""
    assert link_verdict(open_since=1.0, last_data=99.5) == (OK, '/dev/ttyUSB0 is open')


@pytest.mark.parametrize('last_data', [None, 50.0, 95.0])
def test_a_silent_port_is_an_error_that_says_what_to_look_at(last_data):
    """Counted from its opening if nothing ever came, or came from an earlier opening."""
    level, message = link_verdict(open_since=95.0, last_data=last_data)
    assert level == ERROR
    assert message.startswith('/dev/ttyUSB0 is open but silent for 5 s: is the device powered')


def test_a_port_just_opened_is_not_yet_silent():
    """It has a second."""
    assert link_verdict(open_since=99.5)[0] == OK


@pytest.mark.parametrize('received, frames, failures, skipped, level, words', [
    (0, 0, 0, 0, OK, 'Nothing received'),
    (8000, 345, 0, 0, OK, 'All frames intact'),
    (8000, 340, 1, 24, WARN, '1 damaged frames and 24 stray bytes'),
    (8000, 345, 0, 3, WARN, '0 damaged frames and 3 stray bytes'),
    (8000, 240, 105, 2600, ERROR, '30% of the frames are damaged: check cable'),
    (8000, 0, 0, 8000, ERROR, 'Bytes arrive but no frames: is 115200 the baud rate'),
])
def test_framing(received, frames, failures, skipped, level, words):
    """Each state has a message of its own."""
    found, message = judge_framing(received, frames, failures, skipped, 115200)
    assert found == level and words in message


def monitor(clock):
    """Return a monitor of counters that the test may change."""
    receiver = SimpleNamespace(counters=LinkCounters(open_since=0.0, last_data=0.0))
    framer = SimpleNamespace(counters=FramingCounters())
    link = SimpleNamespace(port='/dev/ttyUSB0', baud_rate=115200)
    return Monitor(link, receiver, framer, lambda: {'CRC order': 'word'}, clock), receiver, framer


def test_levels_are_of_the_last_interval_and_values_of_all_time():
    """An error long ago does not keep the level up, and is not forgotten."""
    now = [0.0]
    watch, receiver, framer = monitor(lambda: now[0])

    def second_with(**counts):
        now[0] += 1.0
        receiver.counters.bytes_received += 1000
        receiver.counters.last_data = now[0]
        framer.counters.frames += 50
        framer.counters.crc_failures += counts.get('failures', 0)
        watch.update()
        return {status.name: status for status in watch.statuses()}

    assert second_with(failures=1)['bahrs_driver: Framing'].level == WARN
    statuses = second_with()
    framing = statuses['bahrs_driver: Framing']
    values = {pair.key: pair.value for pair in framing.values}
    assert framing.level == OK
    assert values['CRC failures'] == '1' and values['CRC order'] == 'word'
    link = {pair.key: pair.value for pair in statuses['bahrs_driver: Link'].values}
    assert link['Bytes per second'] == '1000'
    assert framing.hardware_id == '/dev/ttyUSB0'
