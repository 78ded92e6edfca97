# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs doctor`, as a process."""

import json
import subprocess

from bahrs_driver.emulator.pty_port import PtyPort
from devices import Device
from processes import command


def doctor(*words):
    """Return exit status and output."""
    done = subprocess.run(command('bahrs', 'doctor', *words), capture_output=True, text=True,
                          timeout=120, check=False)
    assert done.stderr == ''
    return done.returncode, done.stdout


def test_a_device_that_speaks():
    """Nothing is wrong."""
    with PtyPort() as cable, Device(cable):
        status, text = doctor('--port', cable.path, '--json')
    found = {item['check']: item for item in json.loads(text)}
    assert status == 0, text
    assert found['device']['level'] == 'ok' and 'version 3' in found['device']['message']
    assert all(set(item) == {'check', 'level', 'message', 'command'} for item in found.values())


def test_no_device(tmp_path):
    """The exit status tells, and the command that mends it stands below what is wrong."""
    status, text = doctor('--root', str(tmp_path))
    assert status == 1
    wrong, remedy, *_ = text.splitlines()
    assert wrong.startswith('problem port: /dev/ttyUSB0 does not exist, nor any adapter on USB')
    assert remedy.split('-> ')[1] == 'sudo dmesg --follow'
    assert '\x1b' not in text


def test_a_port_named_from_here(tmp_path, monkeypatch):
    """A relative path is one of this folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'port').touch()
    _, text = doctor('--port', 'port', '--no-listen')
    assert f'{tmp_path}/port is there' in text


def test_a_domain_that_is_none(monkeypatch):
    """It is told with the rest, and ROS is not started in it."""
    monkeypatch.setenv('ROS_DOMAIN_ID', 'abc')
    status, text = doctor('--no-listen')
    assert status == 1
    assert "problem domain: ROS_DOMAIN_ID is 'abc'" in text
