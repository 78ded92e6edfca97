# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what the doctor finds at a port, on machines that are made up file by file."""

import os

from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.usb_port import candidates, check_name, check_port, install_rule
from bahrs_driver.transport.machine import Machine, User
import pytest

RULE = '/somewhere/99-bahrs.rules'
OWN_GID = os.getegid()


class MadeUp:
    """A machine with one adapter and one user, as it should be."""

    def __init__(self, root):
        """Put the files below a folder."""
        self.root, self.groups, self.members = root, {OWN_GID}, set()
        self.write('dev/ttyUSB0', '').chmod(0o660)
        self.link('dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0', '../../ttyUSB0')
        self.write('sys/class/tty/ttyUSB0/dev', '188:0')
        self.write('sys/bus/usb-serial/devices/ttyUSB0/latency_timer', '1')
        self.write('sys/bus/usb/devices/1-2/idVendor', '0403')
        self.write('proc/1/comm', 'systemd')

    def write(self, name, text):
        """Make a file."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def link(self, name, target):
        """Make a symbolic link."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(target)

    def runs(self, pid, name, *words, device=None):
        """Make a process."""
        self.write(f'proc/{pid}/comm', name)
        self.write(f'proc/{pid}/cmdline', '\0'.join([name, *words]) + '\0')
        if device:
            self.link(f'proc/{pid}/fd/7', device)

    def machine(self):
        """Return it."""
        machine = Machine(self.root, User('pilot', 4711, frozenset(self.groups)))
        machine.is_member = lambda gid: gid in self.members
        machine.group_name = lambda gid: 'dialout'
        return machine

    def results(self, port='/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0'):
        """Return what is found at a port, by what was looked at."""
        machine = self.machine()
        return {result.check: result for result in (*check_port(machine, port, RULE),
                                                    *check_name(machine, port, RULE))}


@pytest.fixture
def made_up(tmp_path):
    """Return a machine that is as it should be."""
    return MadeUp(tmp_path)


def test_a_machine_as_it_should_be(made_up):
    """No problem is reported."""
    found = made_up.results()
    assert set(found) == {'port', 'access', 'in use', 'ModemManager', 'latency timer', 'name'}
    assert {result.level for result in found.values()} == {Level.OK}
    assert not any(result.command for result in found.values())
    assert candidates(made_up.machine()) == ['/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0']


def test_another_port(made_up):
    """The one that there is, is named."""
    found = made_up.results('/dev/ttyUSB7')
    assert set(found) == {'port'} and found['port'].level is Level.PROBLEM
    assert found['port'].command == \
        'bahrs doctor --port /dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0'


def without_port(made_up):
    """Return what is found when the adapter has no port."""
    (made_up.root / 'dev/ttyUSB0').unlink()
    return made_up.results('/dev/ttyUSB0')['port']


def test_no_adapter(made_up):
    """It is not on USB at all."""
    (made_up.root / 'sys/bus/usb/devices/1-2/idVendor').write_text('1d6b')
    assert without_port(made_up).command == 'sudo dmesg --follow'


def test_an_adapter_without_its_module(made_up):
    """It is on USB, but no port was made of it."""
    assert without_port(made_up).command == 'sudo modprobe ftdi_sio'


def test_an_adapter_that_brltty_took(made_up):
    """As it does on desktops."""
    made_up.write('usr/lib/udev/rules.d/85-brltty.rules', '')
    assert without_port(made_up).command == 'sudo apt remove brltty'


def test_a_user_who_is_not_in_the_group(made_up):
    """The group to join is named."""
    made_up.groups = {1}
    result = made_up.results()['access']
    assert result.level is Level.PROBLEM
    assert result.command == 'sudo usermod -aG dialout pilot'


def test_a_user_who_has_not_logged_in_again(made_up):
    """Is in the group by the files, but not in this session."""
    made_up.groups, made_up.members = {1}, {OWN_GID}
    assert made_up.results()['access'].command == 'newgrp dialout'


def test_a_port_of_nobody(made_up):
    """No group may use it."""
    (made_up.root / 'dev/ttyUSB0').chmod(0o600)
    result = made_up.results('/dev/ttyUSB0')['access']
    assert result.level is Level.PROBLEM
    assert result.command == 'sudo chgrp dialout /dev/ttyUSB0 && sudo chmod 660 /dev/ttyUSB0'


def test_a_port_in_use(made_up):
    """Process and name are reported."""
    made_up.runs(812, 'minicom', device='/dev/ttyUSB0')
    result = made_up.results()['in use']
    assert result.level is Level.PROBLEM and result.command == 'kill 812'
    assert 'minicom, process 812' in result.message


def test_a_port_that_the_driver_has(made_up):
    """That is as it should be, also where Python runs it under its own name."""
    made_up.runs(813, 'python3', '/opt/bin/driver_node', '--ros-args', device='/dev/ttyUSB0')
    result = made_up.results()['in use']
    assert result.level is Level.OK and 'driver_node, process 813' in result.message


def test_modem_manager(made_up):
    """It runs, and no udev rule excludes the port."""
    made_up.runs(600, 'ModemManager')
    result = made_up.results()['ModemManager']
    assert result.level is Level.PROBLEM and result.command == install_rule(RULE)
    made_up.runs(600, 'ModemManager', device='/dev/ttyUSB0')
    assert made_up.results()['in use'].command == 'sudo systemctl stop ModemManager'


def test_modem_manager_that_was_told(made_up):
    """The udev rule is in force."""
    made_up.runs(600, 'ModemManager')
    made_up.write('run/udev/data/c188:0', 'S:bahrs_A1\nE:ID_MM_DEVICE_IGNORE=1\n')
    assert made_up.results()['ModemManager'].level is Level.OK


def test_a_slow_latency_timer(made_up):
    """It costs latency and breaks nothing."""
    made_up.write('sys/bus/usb-serial/devices/ttyUSB0/latency_timer', '16\n')
    result = made_up.results()['latency timer']
    assert result.level is Level.ADVICE and 'is 16 ms' in result.message
    assert result.command == \
        'echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer'


def test_an_adapter_without_a_latency_timer(made_up):
    """Nothing is reported."""
    (made_up.root / 'sys/bus/usb-serial/devices/ttyUSB0/latency_timer').unlink()
    assert 'latency timer' not in made_up.results()


def test_a_name_that_may_change(made_up):
    """The one that does not is named."""
    result = made_up.results('/dev/ttyUSB0')['name']
    assert result.level is Level.ADVICE
    assert result.command.endswith('port:=/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0')


def test_an_adapter_without_a_stable_name(made_up):
    """The udev rule gives it one."""
    (made_up.root / 'dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0').unlink()
    assert made_up.results('/dev/ttyUSB0')['name'].command == install_rule(RULE)
    assert candidates(made_up.machine()) == ['/dev/ttyUSB0']
