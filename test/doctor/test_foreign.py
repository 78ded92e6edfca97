# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the doctor with arbitrary names, files and variables."""

import os
from pathlib import Path
import shlex
import tempfile

from bahrs_driver.doctor import ros_environment
from bahrs_driver.doctor.commands import run_doctor, run_driver
from bahrs_driver.doctor.driver_health import DriverStatuses
from bahrs_driver.doctor.usb_port import check_name, check_port
from bahrs_driver.process.printable import printable
from bahrs_driver.transport.machine import Machine, User
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from hypothesis import given, settings, strategies as st
from rclpy.serialization import serialize_message

ODD = ['\x1bc', '\n', '; reboot', '$(reboot)', "'", '"', '[bold]', '\udcff', '-rf', '~', ' ']
TEXTS = st.one_of(st.sampled_from(ODD), st.text(
    st.characters(blacklist_characters='\0', blacklist_categories=['Cs']), max_size=12))
NAMES = st.one_of(st.sampled_from(ODD), st.text(
    st.characters(blacklist_characters='\0/', blacklist_categories=['Cs']), min_size=1,
    max_size=12)).filter(lambda name: name not in ('.', '..'))
LONG = '/x' * 3000
CONTENTS = st.one_of(st.binary(max_size=40), TEXTS.map(os.fsencode))
FILES = st.dictionaries(
    st.sampled_from(['sys/class/tty/ttyUSB0/dev', 'proc/7/comm', 'proc/7/cmdline',
                     'run/udev/data/c188:0', 'sys/bus/usb/devices/1-2/idVendor',
                     'sys/bus/usb-serial/devices/ttyUSB0/latency_timer', 'proc/x7/comm']),
    CONTENTS)


def assert_safe(results):
    """Assert that results are printable, and that their commands are safe in a shell."""
    for result in results:
        assert printable(result.message, 2000).isprintable()
        assert result.command == '' or shlex.split(result.command)
        assert 'reboot' not in shlex.split(result.command)


@settings(max_examples=100)
@given(name=NAMES, files=FILES, port=st.sampled_from(['/dev/ttyUSB0', '/dev/{}', '/dev/x' + LONG]))
def test_any_machine(name, files, port):
    """USB descriptors become names of links, and processes choose their names."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        links = root / 'dev/serial/by-id'
        links.mkdir(parents=True)
        (root / 'dev/ttyUSB0').touch()
        (links / name).symlink_to('../../ttyUSB0')
        for file, content in files.items():
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            (root / file).write_bytes(content)
        for user in (User('pilot', 4711, frozenset()), User('root', 0, frozenset())):
            machine = Machine(root, user, {})
            port, rule = port.format(name), f'/{name}/99-bahrs.rules'
            assert_safe([*check_port(machine, port, rule), *check_name(machine, port, rule)])


@given(variables=st.dictionaries(
    st.sampled_from(['AMENT_PREFIX_PATH', 'ROS_DISTRO', 'RMW_IMPLEMENTATION', 'ROS_DOMAIN_ID',
                     'ROS_LOCALHOST_ONLY', 'ROS_AUTOMATIC_DISCOVERY_RANGE', 'ROS_LOG_DIR',
                     'RCUTILS_COLORIZED_OUTPUT', 'HOME']),
    st.one_of(TEXTS, st.just(LONG), TEXTS.map(lambda text: f'/opt/ros/{text}:/opt/ros/jazzy'))),
    has_rclpy=st.booleans())
def test_any_environment(variables, has_rclpy):
    """Environment variables may have any value."""
    assert_safe(ros_environment.check(variables, has_rclpy, Path('/nowhere')))


LEVELS = st.binary(min_size=1, max_size=1)
TEXTS_IN_MESSAGES = st.text(st.characters(blacklist_characters='\0', blacklist_categories=['Cs']),
                            max_size=12)
STATUSES = st.builds(
    DiagnosticStatus, level=LEVELS, message=st.one_of(TEXTS_IN_MESSAGES, st.sampled_from(ODD[:7])),
    name=st.one_of(TEXTS_IN_MESSAGES, TEXTS_IN_MESSAGES.map('left: {}'.format),
                   TEXTS_IN_MESSAGES.map('bahrs_driver: x{}'.format)))


@given(statuses=st.lists(STATUSES, max_size=20), damage=st.binary(max_size=40))
def test_any_diagnostics(statuses, damage):
    """Other nodes publish statuses, too, and bytes may be malformed."""
    found = DriverStatuses(['/bahrs_driver', '/left/front'])
    found.add(serialize_message(DiagnosticArray(status=[
        *statuses, DiagnosticStatus(name='bahrs_driver: Link', level=b'\2', message='\x1bc')])))
    found.add(damage)
    results = list(found.results())
    assert_safe(results)
    assert any('\x1bc' in result.message for result in results)
    assert results[-1].message.startswith('/left/front reports nothing')


@given(port=st.one_of(NAMES, TEXTS).filter(bool), rate=st.integers(1, 10 ** 7))
def test_commands_name_the_port_unchanged(port, rate):
    """The port is one argument in a shell."""
    assert f'port:={port}' in shlex.split(run_driver(port, 'titan_m', rate))
    assert port in shlex.split(run_doctor(port, rate))
