# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What the node says of itself and its device, heard in another process."""

from collections import Counter
import json
import os
import stat
import time

from bahrs_driver.cli.main import main
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import (
    Acknowledgement, HardwareVersion, Navigation, SoftwareVersion,
)
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_msgs.srv import SelfTest
import pytest
from sensor_msgs.msg import Imu
from support.devices import call, Device, DIAGNOSTICS, SAFE, says, status
from support.processes import driver, listening, running, wait_for

OK, WARN = DiagnosticStatus.OK, DiagnosticStatus.WARN
ERROR, STALE = DiagnosticStatus.ERROR, DiagnosticStatus.STALE
TASKS = ['Link', 'Framing', 'Time', 'Rates', 'Integrity', 'Device', 'Publishing']
CODEC = BahrsCodec()


def values(ear, task):
    """Return the latest values of a task."""
    return {pair.key: pair.value for pair in status(ear, task).values}


def count(ear, task, name):
    """Return the latest value of a task that is a count."""
    return int(values(ear, task)[name])


def rate(ear, name):
    """Return the latest measured rate of a message, in Hz."""
    return float(values(ear, 'Rates')[f'{name} [Hz]'].split(' of ')[0])


def flip_in_three_of_ten(data, index):
    """Damage 30 % of the frames."""
    if hash((index, data[4])) % 10 < 3:
        return data[:9] + bytes([data[9] ^ 4]) + data[10:]
    return data


def test_a_healthy_device_is_ok_in_every_task(cable):
    """Its rates are complete."""
    with listening({**DIAGNOSTICS, 'imu/data': Imu}) as ear, driver(cable.path), Device(cable):
        for task in TASKS:
            assert says(ear, task, OK, ''), status(ear, task)
        assert wait_for(lambda: rate(ear, 'inertial') == pytest.approx(200, rel=0.03))
        assert values(ear, 'Rates')['navigation lost'] == '0'
        assert wait_for(lambda: count(ear, 'Publishing', 'imu/data') > 20)
        assert values(ear, 'Integrity')['roll'] == 'safe'


# Faults and their messages, as in the table of the README.
FAULTS = {
    'wrong baud rate': (lambda data, index: bytes(b >> 1 ^ 0xA5 for b in data), 'Framing', ERROR,
                        'Bytes arrive, but no frame of a bahrs: is 115200 the baud rate'),
    'wrong device': (lambda data, index: b'$GPGGA,123519,4807.038,N*47\r\n', 'Framing', ERROR,
                     'Text arrives, but no frame of a bahrs: another device is on this port'),
    'silent device': (lambda data, index: b'', 'Link', ERROR, 'is open but silent'),
    'half-dead cable': (flip_in_three_of_ten, 'Framing', ERROR, 'of the frames are damaged'),
    'diagnostics mode': (lambda data, index: CODEC.encode(Acknowledgement(0xF0, 0), 3)
                         if index % 100 == 0 else b'', 'Rates', STALE, 'in diagnostics mode'),
}


@pytest.mark.parametrize('fault', FAULTS)
def test_each_fault_has_its_own_message(cable, fault):
    """A distinct message with the remedy."""
    change, task, level, words = FAULTS[fault]
    with listening(DIAGNOSTICS) as ear, driver(cable.path), Device(cable, change=change):
        assert says(ear, task, level, words), status(ear, task)
        readme = (os.path.dirname(__file__) + '/../../README.md')
        assert words in open(readme).read()


def test_a_missing_port(tmp_path):
    """It is named."""
    with listening(DIAGNOSTICS) as ear, driver(str(tmp_path / 'ttyUSB0')):
        assert says(ear, 'Link', ERROR, 'ttyUSB0 does not exist: plug the device in')
        assert says(ear, 'Rates', STALE, 'No data from the device')
        assert status(ear, 'Link').hardware_id == str(tmp_path / 'ttyUSB0')


@pytest.mark.skipif(os.geteuid() == 0, reason='root may open every port; test_link has it too')
def test_a_forbidden_port():
    """The group to join is named."""
    with PtyPort() as port:
        os.chmod(port.path, stat.S_IRGRP | stat.S_IWGRP)
        with listening(DIAGNOSTICS) as ear, driver(port.path):
            assert says(ear, 'Link', ERROR, 'may not be opened by user')


@pytest.mark.slow
def test_lost_frames_are_counted_right(tmp_path):
    """As many as the emulator dropped, one in a hundred, over several turns of the counters."""
    port, file, truth = str(tmp_path / 'port'), tmp_path / 'flight.bin', tmp_path / 'truth.jsonl'
    assert main(['emulate', '--output', str(file), '--truth', str(truth), '--duration', '9',
                 '--fault', 'drop_frame=0.01']) == 0
    lost, received = losses(truth)
    # With times of arrival nothing is dropped, however late the host lets the player be.
    with listening(DIAGNOSTICS) as ear, driver(port, time__source='arrival'):
        ear.wait('/diagnostics')
        # An emulator would lose what the node is too busy for; this waits for it.
        with running('bahrs', 'replay', str(file), '--link', port, '--settle', '3') as player:
            assert player.wait() == 0
        assert wait_for(lambda: values(ear, 'Rates')['inertial received']
                        == str(received['inertial']))
        found = values(ear, 'Rates')
    assert {name: int(found[f'{name} lost']) for name in received} == {
        name: lost[name] for name in received}
    assert sum(lost.values()) > 10
    assert any('Lost just now' in item.message for array in ear.messages['/diagnostics']
               for item in array.status)


def losses(truth):
    """Return how many messages were dropped, by name, and how many arrived."""
    lost, received, dropped = Counter(), Counter(), Counter()
    for line in truth.read_text().splitlines():
        entry = json.loads(line)
        name = entry.get('message')
        if 'sequence' not in entry:
            continue
        if entry['wire'] == 'intact':
            # Only now can anybody know of what was dropped before.
            lost[name] += dropped.pop(name, 0)
            received[name] += 1
        else:
            dropped[name] += 1
    return lost, received


def test_the_device_gives_its_name(cable):
    """Project code and unique number, once they were received."""
    with listening(DIAGNOSTICS) as ear, driver(cable.path):
        assert wait_for(lambda: cable.is_open)
        with Device(cable):
            assert says(ear, 'Rates', OK, '')
            cable.write(CODEC.encode(SoftwareVersion('OSS', 2, 7), 3)
                        + CODEC.encode(HardwareVersion(0x450, (1, 2, 3)), 3))
            assert says(ear, 'Device', OK, 'OSS 2.7')
            assert wait_for(lambda: values(ear, 'Device')['Device id']
                            == 'OSS-000000010000000200000003')
            ear.wait('/diagnostics', len(ear.messages['/diagnostics']) + 1)
    assert {(item.name.split(': ')[0], item.hardware_id) for array in ear.messages['/diagnostics']
            for item in array.status} == {('bahrs_driver', cable.path)}     # they never change


def test_a_project_code_that_commands_terminals(cable):
    """The message has it."""
    with listening(DIAGNOSTICS) as ear, driver(cable.path):
        assert wait_for(lambda: cable.is_open)
        with Device(cable):
            cable.write(CODEC.encode(SoftwareVersion('\x1bc\n', 2, 7), 3)
                        + CODEC.encode(HardwareVersion(0x450, (1, 2, 3)), 3))
            assert says(ear, 'Device', OK, r'\x1bc\x0a 2.7')
        assert wait_for(lambda: values(ear, 'Device')['Device id'].startswith(r'\x1bc\x0a-0'))


@pytest.mark.parametrize('words, name', [
    ([], 'bahrs_driver'),
    (['-r', '__node:=front'], 'front'),
    (['-r', '__ns:=/left'], '/left/bahrs_driver'),
    (['-r', '__ns:=/uav/left', '-r', '__node:=front'], '/uav/left/front'),
    (['-p', 'diagnostics.qualified_name:=true'], '/bahrs_driver'),
    (['-p', 'diagnostics.qualified_name:=true', '-r', '__ns:=/left'], '/left/bahrs_driver'),
])
def test_names_are_those_of_the_node(cable, words, name):
    """Fully qualified in a namespace: every driver has its own names."""
    with listening(DIAGNOSTICS) as ear, running(
            'driver_node', '--ros-args', '-p', f'port:={cable.path}', *words):
        (first, *_) = ear.wait('/diagnostics')
    assert [item.name for item in first.status] == [f'{name}: {task}' for task in TASKS]


def test_which_signals_are_affected_is_reported_at_once(cable):
    """Even if the level stays; a report each second would take four times the limit."""
    affected, turns = [0], 40
    signals = ['pressure_height', 'velocity_down', 'roll', 'pitch', 'magnetic_heading']

    def health(index):
        return SAFE, tuple(Integrity.INTEGRITY_RISK if number == affected[0] else Integrity.SAFE
                           for number in range(5))

    with listening(DIAGNOSTICS) as ear, driver(cable.path), Device(cable, health=health):
        assert says(ear, 'Integrity', WARN, f'{signals[0]} integrity risk')
        begin = time.monotonic()
        for turn in range(turns):
            affected[0] = turn % 5
            assert says(ear, 'Integrity', WARN, f'{signals[turn % 5]} integrity risk')
        assert time.monotonic() - begin < turns / 4


def test_what_changes_with_every_sample_is_reported_twenty_times_a_second(cable):
    """The last report has the last state."""
    still = [False]

    def health(index):
        risk = Integrity.INTEGRITY_RISK if index % 4 or still[0] else Integrity.SAFE
        return SAFE, (risk, *SAFE[:4])

    with listening(DIAGNOSTICS) as ear, driver(cable.path), Device(cable, health=health):
        begin = time.monotonic()
        ear.wait('/diagnostics', 100)
        still[0] = True
        assert says(ear, 'Integrity', WARN, 'integrity risk')
        count, elapsed = len(ear.messages['/diagnostics']), time.monotonic() - begin
    # What went out while the listener was held up comes at once.
    assert count <= 20 * (elapsed + 2.0)


def test_self_test(cable):
    """It fails on a silent device, and passes on a healthy one."""
    with listening(DIAGNOSTICS) as ear, driver(cable.path):
        def ask():
            return call(ear, SelfTest, '/bahrs_driver/self_test', SelfTest.Request())

        before = ask()
        assert before.passed == b'\x00' and before.id == cable.path
        with Device(cable):
            # A busy machine may make rates look wrong for a moment.
            assert wait_for(lambda: ask().passed == b'\x01'), ask()
            after = ask()
        assert [item.name for item in after.status] == [
            'Port open and bytes flowing', 'Frames valid', 'Rates right', 'Integrity safe',
            'Clock settled', 'Device plausible']


def test_a_height_read_with_the_wrong_sign_names_the_parameter(cable):
    """As the document has it: above 4,500 m it comes out negative."""
    def high(data, index):
        if data[4] != Navigation.TYPE:
            return data
        return CODEC.encode(Navigation(index // 2 % 256, 6000.0, 0.0, 0.0, 0.0, 0.0,
                                       SAFE[:5]), 3)

    with listening(DIAGNOSTICS) as ear, driver(cable.path, pressure_height__format='int16'), \
            Device(cable, change=high):
        assert says(ear, 'Device', WARN, 'is pressure_height.format right?')
