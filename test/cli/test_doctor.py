# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs doctor`, as a process."""

import contextlib
import json
import os
import subprocess

from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.processes import command, running, wait_for

ODD = 'usb-\x1bc; reboot\n'
WAYS = [('/dev/nowhere',), ('--port', '/dev/nowhere'),
        ('/dev/nowhere', '--port', '/dev/nowhere')]


class Doctor:
    """A run of the command, which waits some seconds until it reports that no driver runs."""

    def __init__(self, *words, cwd=None, **variables):
        """Start it, in a folder and with variables of the environment."""
        self._child = subprocess.Popen(
            command('bahrs', 'doctor', *words), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, cwd=cwd, env={**os.environ, **variables})

    def end(self):
        """Return exit status and output."""
        text, complaints = self._child.communicate(timeout=120)
        assert complaints == ''
        return self._child.returncode, text

    def close(self):
        """Kill it if it still runs."""
        if self._child.poll() is None:
            self._child.kill()
        self._child.communicate()


def doctor(*words, **options):
    """Return exit status and output."""
    with contextlib.closing(Doctor(*words, **options)) as run:
        return run.end()


@pytest.fixture(scope='module')
def runs(tmp_path_factory):
    """Start the runs without a device together: each waits for drivers."""
    here, empty, odd = (tmp_path_factory.mktemp(name) for name in ('here', 'empty', 'odd'))
    (here / 'port').touch()
    by_id = odd / 'dev/serial/by-id'
    by_id.mkdir(parents=True)
    (odd / 'dev/ttyUSB0').touch()
    (by_id / ODD).symlink_to('../../ttyUSB0')
    with contextlib.ExitStack() as stack:
        def start(*words, **options):
            return stack.enter_context(contextlib.closing(Doctor(*words, **options)))

        yield {
            'directory': here,
            'no device': start('--root', str(empty)),
            'relative': start('--port', 'port', '--no-listen', cwd=here),
            'odd names': start('--root', str(odd), '--no-listen', '/dev/ttyUSB0',
                               ROS_DISTRO='\x1b[2J'),
            **{words: start(*words, '--no-listen') for words in WAYS}}


def test_a_streaming_device():
    """There is no problem."""
    with PtyPort() as cable, Device(cable):
        status, text = doctor('--port', cable.path, '--json')
    found = {item['check']: item for item in json.loads(text)}
    assert status == 0, text
    assert found['device']['level'] == 'ok' and 'version 3' in found['device']['message']
    assert all(set(item) == {'check', 'level', 'message', 'command'} for item in found.values())


def test_no_device(runs):
    """The exit status is 1, and each problem is followed by its command."""
    status, text = runs['no device'].end()
    assert status == 1
    wrong, remedy, *_ = text.splitlines()
    assert wrong.startswith('problem port: /dev/ttyUSB0 does not exist, and no adapter is '
                            'on USB')
    assert remedy.split('-> ')[1] == 'sudo dmesg --follow'
    assert '\x1b' not in text


def test_a_relative_path_of_a_port(runs):
    """It is relative to the current directory."""
    _, text = runs['relative'].end()
    assert f"{runs['directory']}/port exists" in text


def test_an_invalid_domain(monkeypatch):
    """It is reported, and ROS is not started."""
    monkeypatch.setenv('ROS_DOMAIN_ID', 'abc')
    status, text = doctor('--no-listen')
    assert status == 1
    assert "problem domain: ROS_DOMAIN_ID is 'abc'" in text


def test_a_device_that_only_answers(tmp_path):
    """Every command that starts a driver names the sensor."""
    port = str(tmp_path / 'port')
    with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', port) as emulator:
        assert wait_for(lambda: emulator.lines, 60)
        status, text = doctor('--port', port, '--ask', '--json')
    commands = [item['command'] for item in json.loads(text) if 'driver_node' in item['command']]
    assert commands and all('-p sensor:=titan_m ' in command for command in commands)
    assert status == 0, text


@pytest.mark.parametrize('words', WAYS)
def test_port_with_and_without_option(runs, words):
    """Other verbs take --port, too."""
    status, text = runs[words].end()
    assert status == 1 and text.startswith('problem port: /dev/nowhere does not exist')


def test_two_ports():
    """They are refused."""
    done = subprocess.run(command('bahrs', 'doctor', '/dev/a', '--port', '/dev/b'),
                          capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1
    assert done.stderr == "bahrs doctor: '/dev/a' and --port '/dev/b' are two ports: name one\n"


def test_names_with_control_characters(runs):
    """They are escaped, and quoted in commands."""
    _, text = runs['odd names'].end()
    assert '\x1b' not in text and r'usb-\x1bc; reboot\x0a' in text
    assert all(line.startswith(('ok', 'advice', 'problem', ' ' * 8)) for line in text.splitlines())
    (command_line,) = (line for line in text.splitlines() if 'reboot' in line and '->' in line)
    assert "-p 'port:=/dev/serial/by-id/usb-" in command_line
