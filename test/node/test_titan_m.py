# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The node with a Titan-M, as a process, against a device that is a few lines."""

from contextlib import contextmanager
import threading

from bahrs_driver.convert.titan_m.converter import TOPICS
from bahrs_driver.protocol.titan_m.frames import build_answer
from bahrs_driver.protocol.titan_m.messages import Gps, Sensors, State
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from support.devices import DIAGNOSTICS, says, status
from support.processes import driver, listening, running, wait_for

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
EVERYTHING = {**TOPICS, **DIAGNOSTICS}
HALF_WEEK = 7 * 86_400 // 2
STATE = State((1.0, 2.0, -3.0), (0.5, -0.25, 0.0), (0.125, -0.5, 1.5), (0.0, 0.0625, -1.0))
GPS = Gps(1.5, 500_000.0, 5_000_000.0, 600.0, (1.0, 2.0, 3.0), 90.0, 4.0, 3.0, 32, True)
SENSORS = Sensors((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 20.0, (0.5, 0.25, -9.75), (0.0, 0.0, 0.5),
                  95_000.0, 12.5, (2e-5, 0.0, 4e-5))
# The requests of the document, byte for byte.
REQUESTS = {bytes.fromhex('3347535402000123'): STATE, bytes.fromhex('3347475002000113'): GPS,
            bytes.fromhex('3347534502000114'): SENSORS}


def answers(**options):
    """Return the answer to each request."""
    return {request: build_answer(message, 0x5A, **options)
            for request, message in REQUESTS.items()}


@contextmanager
def titan(port, replies):
    """Answer requests by a table that may change; yield the table and the requests in order."""
    asked, ended = [], threading.Event()

    def serve():
        buffer = b''
        while not ended.is_set():
            buffer += port.read(0.05) if port.wait_until_open(0.05) else b''
            while len(buffer) >= 8:
                request, buffer = buffer[:8], buffer[8:]
                asked.append(request)
                port.write(replies.get(request, b''))

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield asked
    finally:
        ended.set()
        thread.join()


def values(ear, task):
    """Return the values of a task."""
    return {pair.key: pair.value for pair in status(ear, task).values}


@pytest.mark.parametrize('payload, checksum', [('little', 'big'), ('big', 'little')])
def test_all_topics_in_another_process(cable, payload, checksum):
    """Byte orders are found and shown; only the open port is logged."""
    replies = answers(payload_order=payload, checksum_order=checksum)
    with listening(EVERYTHING) as ear, titan(cable, replies), \
            driver(cable.path, sensor='titan_m') as node:
        for topic in TOPICS:
            ear.wait(topic, 3, 60)
        assert ear.messages['fix'][-1].longitude == pytest.approx(9.0)
        assert ear.messages['velocity'][-1].twist.twist.linear.y == 0.5
        # Not where a slow machine let more than 25 ms go by between the two answers.
        assert wait_for(lambda: any(imu.linear_acceleration.x == 0.5
                                    for imu in ear.messages['imu/data']), 60)
        assert ear.messages['imu/mag'][-1].magnetic_field.z == pytest.approx(-4e-5, abs=4e-9)
        assert ear.messages['differential_pressure'][-1].fluid_pressure == 12.5
        stamps = [message.header.stamp for message in ear.messages['velocity']]
        times = [stamp.sec * 10 ** 9 + stamp.nanosec for stamp in stamps]
        assert times == sorted(set(times))
        assert wait_for(lambda: status(ear, 'Device'), 30)
        assert says(ear, 'Device', OK, 'fix in zone 32 north')
        framing = values(ear, 'Framing')
        assert framing['Payload byte order'] == payload
        assert framing['Checksum byte order'] == checksum
        assert says(ear, 'Time', OK, 'the middle of request and answer')
        assert node.end() == 0 and len(node.lines) == 1, node.text


def test_a_device_that_does_not_answer_is_told_and_asked_again(cable):
    """In the other byte order of the checksum, too."""
    replies = {}
    with listening(EVERYTHING) as ear, titan(cable, replies) as asked, \
            driver(cable.path, sensor='titan_m'):
        assert wait_for(lambda: len(asked) > 12, 60)
        assert says(ear, 'Requests', ERROR, 'No request is answered')
        sums = {(sum(request[:6]).to_bytes(2, 'big'), request[6:]) for request in asked}
        assert {found == right for right, found in sums} == {True, False}
        # It wants little-endian checksums.
        replies.update({request[:-2] + request[:-3:-1]: answer
                        for request, answer in answers().items()})
        ear.wait('velocity', 5, 60)
        ear.wait('fix', 2, 60)
        assert values(ear, 'Requests')['Checksum byte order of requests'] in ('big', 'little')


def test_nothing_is_published_before_the_byte_order_is_known(cable):
    """A forced order is used."""
    nothing = {REQUEST: build_answer(State(*[(0.0,) * 3] * 4)) for REQUEST in REQUESTS}
    rates = {'gps__rate': 0.0, 'sensors__rate': 0.0, 'sensor': 'titan_m'}
    with listening(EVERYTHING) as ear, titan(cable, nothing) as asked:
        with driver(cable.path, **rates):
            assert says(ear, 'Device', WARN, 'The byte order of payloads is not known yet')
            assert wait_for(lambda: len(asked) > 50, 60)
            assert not ear.messages['velocity']
        with driver(cable.path, payload_order='big', **rates):
            ear.wait('velocity', 5, 60)
            # In either checksum order: where an answer is late, the other one is tried.
            assert {request[:4] for request in asked} == {b'3GST'}


def test_unplugged_and_plugged_again(tmp_path):
    """Each request is repeated."""
    link = str(tmp_path / 'ttyUSB0')
    with listening(EVERYTHING) as ear, driver(link, sensor='titan_m') as node:
        for _ in range(3):
            with PtyPort(link) as port, titan(port, answers()):
                before = len(ear.messages['odometry'])
                ear.wait('odometry', before + 10, 60)
        assert wait_for(lambda: sum('is gone' in line for line in node.lines) == 3, 30)
        assert node.end() == 0 and 'Traceback' not in node.text


def test_without_rates_it_listens(cable):
    """Answers to requests of another program."""
    rates = {'state__rate': 0.0, 'gps__rate': 0.0, 'sensors__rate': 0.0}
    with listening(EVERYTHING) as ear, titan(cable, {}) as asked, \
            driver(cable.path, sensor='titan_m', **rates) as node:
        assert wait_for(lambda: 'is open' in node.text, 60)
        assert 'are all 0: nothing is requested' in node.text

        def heard():
            cable.write(b''.join(answers().values()))
            return all(ear.messages[topic] for topic in TOPICS)
        assert wait_for(heard, 60)
        assert asked == [] and says(ear, 'Time', OK, 'Stamps are arrival times')


@pytest.mark.parametrize('words, sentence', [
    (['-p', 'state.rate:=1500.0'], 'parameter state.rate is 1500.0: it must be 0 or a decimal'),
    (['-p', 'payload_order:=middle'], "parameter payload_order is 'middle': it must be 'auto' or"),
    (['-p', 'request.retries:=-1'], 'parameter request.retries is -1: it must be a whole number'),
])
def test_a_bad_parameter_ends_the_start_with_one_sentence(words, sentence):
    """As with any other."""
    with running('driver_node', '--ros-args', '-p', 'sensor:=titan_m', *words) as node:
        assert node.wait(60) == 1
        assert len(node.lines) == 1 and sentence in node.text


def test_a_stale_gps_week_is_reported_and_not_used(cable):
    """Its time would be wrong by whole weeks, unnoticed in a recording."""
    with listening(EVERYTHING) as ear, titan(cable, answers()), \
            driver(cable.path, sensor='titan_m', gps__week=2300) as node:
        message = ear.wait('time_reference', 3)[-1]
        assert abs(message.time_ref.sec - message.header.stamp.sec) <= HALF_WEEK
        assert says(ear, 'Device', WARN, 'It is week 2300 by gps.week and week ')
        assert sum('correct gps.week, or leave it 0' in line for line in node.lines) == 1


def test_what_will_not_go_well_is_told_at_the_start(cable):
    """Rates beyond the capacity of the line, and sync pulses that do not exist."""
    with driver(cable.path, sensor='titan_m', baud_rate=9600, time__source='sync_pulse') as node:
        assert wait_for(lambda: '679% of what the line carries at 9600 baud' in node.text, 60)
        assert 'a titan_m has no sync pulses' in node.text
