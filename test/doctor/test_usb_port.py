# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the checks of a port, on machines that are simulated by files."""

import os

from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.usb_port import candidates, check_name, check_port, install_rule
from bahrs_driver.transport.machine import Machine, User
import pytest

RULE = '/somewhere/99-bahrs.rules'
OWN_GID = os.getegid()


class SimulatedMachine:
    """A machine without problems, with one adapter and one user."""

    def __init__(self, root):
        """Create the files in a folder."""
        self.root, self.groups, self.members = root, {OWN_GID}, set()
        self.write('dev/ttyUSB0', '').chmod(0o660)
        self.link('dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0', '../../ttyUSB0')
        self.write('sys/class/tty/ttyUSB0/dev', '188:0')
        self.write('sys/bus/usb-serial/devices/ttyUSB0/latency_timer', '1')
        self.write('sys/bus/usb/devices/1-2/idVendor', '0403')
        self.write('proc/1/comm', 'systemd')

    def write(self, name, text):
        """Write a file."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def link(self, name, target):
        """Create a symbolic link."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(target)

    def runs(self, pid, name, *words, device=None):
        """Create a process."""
        self.write(f'proc/{pid}/comm', name)
        self.write(f'proc/{pid}/cmdline', '\0'.join([name, *words]) + '\0')
        if device:
            self.link(f'proc/{pid}/fd/7', device)

    def machine(self):
        """Return the machine."""
        machine = Machine(self.root, User('pilot', 4711, frozenset(self.groups)))
        machine.is_member = lambda gid: gid in self.members
        machine.group_name = lambda gid: 'dialout'
        return machine

    def results(self, port='/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0'):
        """Return the results for a port by check."""
        machine = self.machine()
        return {result.check: result for result in (*check_port(machine, port, RULE),
                                                    *check_name(machine, port, RULE))}


@pytest.fixture
def machine(tmp_path):
    """Return a machine without problems."""
    return SimulatedMachine(tmp_path)


def test_a_machine_without_problems(machine):
    """No problem is reported."""
    found = machine.results()
    assert set(found) == {'port', 'access', 'in use', 'ModemManager', 'latency timer', 'name'}
    assert {result.level for result in found.values()} == {Level.OK}
    assert not any(result.command for result in found.values())
    assert candidates(machine.machine()) == ['/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0']


def test_a_missing_port_with_another_adapter(machine):
    """The message names the existing port."""
    found = machine.results('/dev/ttyUSB7')
    assert set(found) == {'port'} and found['port'].level is Level.PROBLEM
    assert found['port'].command == \
        'bahrs doctor --port /dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0'


def without_port(machine):
    """Return the result for an adapter without a port."""
    (machine.root / 'dev/ttyUSB0').unlink()
    return machine.results('/dev/ttyUSB0')['port']


def test_no_adapter_on_usb(machine):
    """The command shows the messages of the kernel."""
    (machine.root / 'sys/bus/usb/devices/1-2/idVendor').write_text('1d6b')
    assert without_port(machine).command == 'sudo dmesg --follow'


def test_an_adapter_without_its_kernel_module(machine):
    """It is on USB, but has no port."""
    assert without_port(machine).command == 'sudo modprobe ftdi_sio'


def test_an_adapter_taken_by_brltty(machine):
    """Desktop installations have brltty."""
    machine.write('usr/lib/udev/rules.d/85-brltty.rules', '')
    assert without_port(machine).command == 'sudo apt remove brltty'


def test_a_user_who_is_not_in_the_group(machine):
    """The command adds the user to the group."""
    machine.groups = {1}
    result = machine.results()['access']
    assert result.level is Level.PROBLEM
    assert result.command == 'sudo usermod -aG dialout pilot'


def test_a_user_who_must_log_in_again(machine):
    """The user is in the group, but not in this session."""
    machine.groups, machine.members = {1}, {OWN_GID}
    assert machine.results()['access'].command == 'newgrp dialout'


def test_a_port_without_a_group(machine):
    """Only root may use it."""
    (machine.root / 'dev/ttyUSB0').chmod(0o600)
    result = machine.results('/dev/ttyUSB0')['access']
    assert result.level is Level.PROBLEM
    assert result.command == 'sudo chgrp dialout /dev/ttyUSB0 && sudo chmod 660 /dev/ttyUSB0'


def test_a_port_in_use(machine):
    """The message names the process."""
    machine.runs(812, 'minicom', device='/dev/ttyUSB0')
    result = machine.results()['in use']
    assert result.level is Level.PROBLEM and result.command == 'kill 812'
    assert 'minicom, process 812' in result.message


def test_a_port_in_use_by_the_driver(machine):
    """It is no problem, even if the process has the name of Python."""
    machine.runs(813, 'python3', '/opt/bin/driver_node', '--ros-args', device='/dev/ttyUSB0')
    result = machine.results()['in use']
    assert result.level is Level.OK and 'driver_node, process 813' in result.message


def test_modem_manager(machine):
    """It is a problem if no udev rule excludes the port."""
    machine.runs(600, 'ModemManager')
    result = machine.results()['ModemManager']
    assert result.level is Level.PROBLEM and result.command == install_rule(RULE)
    machine.runs(600, 'ModemManager', device='/dev/ttyUSB0')
    assert machine.results()['in use'].command == 'sudo systemctl stop ModemManager'


def test_modem_manager_with_the_udev_rule(machine):
    """The rule makes it ignore the port."""
    machine.runs(600, 'ModemManager')
    machine.write('run/udev/data/c188:0', 'S:bahrs_A1\nE:ID_MM_DEVICE_IGNORE=1\n')
    assert machine.results()['ModemManager'].level is Level.OK


def test_a_slow_latency_timer(machine):
    """The result is advice."""
    machine.write('sys/bus/usb-serial/devices/ttyUSB0/latency_timer', '16\n')
    result = machine.results()['latency timer']
    assert result.level is Level.ADVICE and 'is 16 ms' in result.message
    assert result.command == \
        'echo 1 | sudo tee /sys/bus/usb-serial/devices/ttyUSB0/latency_timer'


def test_an_adapter_without_a_latency_timer(machine):
    """There is no result."""
    (machine.root / 'sys/bus/usb-serial/devices/ttyUSB0/latency_timer').unlink()
    assert 'latency timer' not in machine.results()


def test_a_name_that_may_change(machine):
    """The message names the stable one."""
    result = machine.results('/dev/ttyUSB0')['name']
    assert result.level is Level.ADVICE
    assert result.command.endswith('port:=/dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0')


def test_an_adapter_without_a_stable_name(machine):
    """The command installs the udev rule."""
    (machine.root / 'dev/serial/by-id/usb-FTDI_FT232R_A1-if00-port0').unlink()
    assert machine.results('/dev/ttyUSB0')['name'].command == install_rule(RULE)
    assert candidates(machine.machine()) == ['/dev/ttyUSB0']
