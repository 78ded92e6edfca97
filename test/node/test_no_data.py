# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Without data, no task of the diagnostics is content, and the console says why."""

import contextlib
import threading

from bahrs_driver.transport.link import Link
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from support.devices import Device, DIAGNOSTICS, says, status
from support.processes import driver, listening, running, wait_for

OK, STALE = DiagnosticStatus.OK, DiagnosticStatus.STALE
TASKS = {'bahrs': {'Link', 'Framing', 'Time', 'Rates', 'Integrity', 'Device', 'Publishing'},
         'titan_m': {'Link', 'Framing', 'Time', 'Rates', 'Requests', 'Device', 'Publishing'}}
NOISE = bytes(range(7, 256, 3))
TEXT = b'$GPGGA,123519,4807.038,N*47\r\n'


@contextlib.contextmanager
def sending(port, data):
    """Send data again and again, ten times a second, for the length of a block."""
    ended = threading.Event()

    def send():
        while not ended.wait(0.1):
            port.write_nowait(data)

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def missing(path):
    """Return a port that does not exist."""
    return contextlib.nullcontext()


@contextlib.contextmanager
def held(path):
    """Return a port that another program holds."""
    with PtyPort(path):
        other = Link(path, 115200)
        other.connect()
        yield
        other.close()


def silent(path):
    """Return a port on which nothing arrives."""
    return PtyPort(path)


@contextlib.contextmanager
def noisy(path):
    """Return a port on which bytes without frames arrive."""
    with PtyPort(path) as port, sending(port, NOISE):
        yield


STATES = {'missing': (missing, 'does not exist'), 'held': (held, 'in use by another program'),
          'silent': (silent, 'is open but silent'), 'noisy': (noisy, 'is open')}


def levels(ear):
    """Return the latest level of each task, by name."""
    return {item.name.rpartition(': ')[2]: item.level
            for item in ear.messages['/diagnostics'][-1].status}


def content(ear):
    """Return the tasks that are OK in the latest report."""
    return {name for name, level in levels(ear).items() if level == OK}


@pytest.mark.parametrize('sensor', TASKS)
@pytest.mark.parametrize('state', STATES)
def test_no_task_is_content_without_data(tmp_path, state, sensor):
    """Except for the link, while bytes arrive on it."""
    make, words = STATES[state]
    path = str(tmp_path / 'port')
    with make(path), listening(DIAGNOSTICS) as ear, driver(path, sensor=sensor):
        assert wait_for(lambda: status(ear, 'Link') and words in status(ear, 'Link').message)
        assert set(levels(ear)) == TASKS[sensor]
        allowed = {'Link'} if state == 'noisy' else set()
        assert wait_for(lambda: content(ear) == allowed), levels(ear)
        ear.wait('/diagnostics', len(ear.messages['/diagnostics']) + 2)
        assert content(ear) == allowed


def test_no_task_stays_content_once_the_port_is_gone(tmp_path):
    """Although all were OK just before; the link stays in error."""
    path = str(tmp_path / 'port')
    with listening(DIAGNOSTICS) as ear, driver(path) as node:
        with PtyPort(path) as port, Device(port):
            assert wait_for(lambda: ear.messages['/diagnostics']
                            and content(ear) == TASKS['bahrs']), levels(ear)
        assert wait_for(lambda: not content(ear)), levels(ear)
        seen = len(ear.messages['/diagnostics'])
        ear.wait('/diagnostics', seen + 3)
        later = [item.message for array in ear.messages['/diagnostics'][seen:]
                 for item in array.status if item.name.endswith(': Link')]
        assert all('is gone' in message for message in later), later
        assert 'does not exist' not in node.text.partition('is gone')[2]


def test_no_task_of_a_titan_m_stays_content_once_the_port_is_gone(tmp_path):
    """Although it answered just before."""
    path = str(tmp_path / 'port')
    rates = {'state__rate': 20, 'sensors__rate': 5, 'gps__rate': 1}         # for a busy host
    with listening(DIAGNOSTICS) as ear, driver(path, sensor='titan_m', **rates):
        with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', path):
            for task in ('Link', 'Framing', 'Time', 'Rates', 'Requests', 'Publishing'):
                assert says(ear, task, OK, ''), status(ear, task)
        assert wait_for(lambda: not content(ear)), levels(ear)


@pytest.mark.parametrize('sensor', TASKS)
@pytest.mark.parametrize('data, words', [
    (NOISE, 'Bytes arrive, but no frame of a'), (TEXT, 'another device is on this port')])
def test_the_console_says_why_there_are_no_frames(tmp_path, data, words, sensor):
    """Once for any amount of noise, and once when frames arrive."""
    path = str(tmp_path / 'port')
    with PtyPort(path) as port, driver(path, sensor=sensor) as node:
        with sending(port, 9 * data):
            assert wait_for(lambda: words in node.text), node.text
            assert not wait_for(lambda: len(node.lines) > 2, 3.0), node.text
        if sensor == 'bahrs':
            with Device(port):
                assert wait_for(lambda: 'frames arrive intact' in node.text), node.text
            assert sum(words in line for line in node.lines) == 1


def test_the_console_says_that_a_device_is_silent(tmp_path):
    """With the hint for a Titan-M."""
    path = str(tmp_path / 'port')
    with PtyPort(path) as port, driver(path) as node:
        assert wait_for(lambda: 'is open but silent: is the device powered' in node.text)
        assert 'for one, set parameter sensor to titan_m' in node.text
        with Device(port):
            assert wait_for(lambda: 'is in order again' in node.text), node.text
        assert sum('silent' in line for line in node.lines) == 1


def test_a_titan_m_on_the_port_of_a_bahrs_answers_once_it_is_asked(tmp_path):
    """As the message says."""
    path = str(tmp_path / 'port')
    with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', path) as device, \
            listening(DIAGNOSTICS) as ear:
        assert wait_for(lambda: device.lines)
        with driver(path):
            assert says(ear, 'Link', DiagnosticStatus.ERROR, 'sensor to titan_m')
        with driver(path, sensor='titan_m'):
            assert says(ear, 'Rates', OK, ''), status(ear, 'Rates')
