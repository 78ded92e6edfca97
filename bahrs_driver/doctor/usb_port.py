# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Check the port: its existence, access, other programs, and the settings of its adapter."""

from collections.abc import Callable, Iterator
import os
import shlex

from bahrs_driver.doctor.check_result import advice, CheckResult, ok, Prevents, problem
from bahrs_driver.doctor.commands import run_doctor, run_driver
from bahrs_driver.transport.explain import describe_process
from bahrs_driver.transport.machine import Machine
from bahrs_driver.transport.port_access import access_advice

PORTS = ('ttyUSB', 'ttyACM')
BY_ID = '/dev/serial/by-id'
RULE = '99-bahrs.rules'
RULES_FOLDERS = ('/etc/udev/rules.d', '/run/udev/rules.d', '/usr/lib/udev/rules.d',
                 '/lib/udev/rules.d')
DRIVERS = {'0403': 'ftdi_sio', '10c4': 'cp210x', '1a86': 'ch341', '067b': 'pl2303'}
OUR_DRIVER = 'driver_node'
MODEM_MANAGER = 'ModemManager'


def install_rule(rule: str) -> str:
    """Return the command that installs the udev rule at a path."""
    return (f'sudo cp {shlex.quote(rule)} /etc/udev/rules.d/ && sudo udevadm control --reload && '
            'sudo udevadm trigger')


def candidates(machine: Machine) -> list[str]:
    """Return the ports of USB adapters, by their stable names where they have one."""
    stable = {machine.resolved(name): name for name in machine.names(BY_ID)}
    return [stable.get(name, name) for name in machine.names('/dev')
            if os.path.basename(name).startswith(PORTS)]


def check_port(machine: Machine, port: str, rule: str) -> Iterator[CheckResult]:
    """Check whether a port exists, is accessible and free; rule is the path of the udev rule."""
    try:
        os.stat(machine.path(port))
    except PermissionError:
        yield _access(machine, port)
        return
    except OSError:
        yield _missing(machine, port)
        return
    device = machine.resolved(port)
    yield ok('port', f'{port} exists' + (f' ({device})' if device != port else ''))
    yield _access(machine, port)
    yield from _busy(machine, port, device)
    yield from _modem_manager(machine, device, rule)
    yield from _latency(machine, device)


def _missing(machine: Machine, port: str) -> CheckResult:
    others = candidates(machine)
    if others:
        return problem('port', f'{port} does not exist, but {", ".join(others)} does',
                       run_doctor(others[0]), Prevents.LISTENING)
    for name in machine.names('/sys/bus/usb/devices'):
        driver = DRIVERS.get(machine.read(f'{name}/idVendor') or '')
        if driver:
            return _no_tty(machine, port, driver)
    return problem('port', f'{port} does not exist, and no adapter is on USB: plug it in and '
                           'watch the messages of the kernel', 'sudo dmesg --follow',
                   Prevents.LISTENING)


def _no_tty(machine: Machine, port: str, driver: str) -> CheckResult:
    rules = [name for folder in RULES_FOLDERS for name in machine.names(folder)]
    if any('brltty' in os.path.basename(name) for name in rules):
        return problem('port', f'{port} does not exist: an adapter is on USB, but brltty takes it '
                               'for a Braille display', 'sudo apt remove brltty',
                       Prevents.LISTENING)
    return problem('port', f'{port} does not exist: an adapter is on USB, but its kernel module '
                           f'{driver} made no port of it', f'sudo modprobe {driver}',
                   Prevents.LISTENING)


def _access(machine: Machine, port: str) -> CheckResult:
    found = access_advice(machine, port)
    if found is None:
        return ok('access', f'user {machine.user.name} may open it')
    return problem('access', f'user {machine.user.name} may not open {port}: {found.reason}; '
                             f'{found.remedy}', found.command, Prevents.LISTENING)


def _busy(machine: Machine, port: str, device: str) -> Iterator[CheckResult]:
    holders = machine.holders(device)
    for process in holders:
        message = f'{port} is open in {describe_process(process)}'
        if process.name == OUR_DRIVER:
            yield ok('in use', f'{message}: the driver runs', Prevents.LISTENING)
        elif process.name == MODEM_MANAGER:
            yield problem('in use', message, 'sudo systemctl stop ModemManager',
                          Prevents.LISTENING)
        else:
            yield problem('in use', message, f'kill {process.pid}', Prevents.LISTENING)
    if not holders and machine.all_visible():
        yield ok('in use', 'no other process has it open')
    elif not holders:
        yield ok('in use', f'no process of user {machine.user.name} has it open; processes of '
                           'other users are not visible')


def _modem_manager(machine: Machine, device: str, rule: str) -> Iterator[CheckResult]:
    name = os.path.basename(device)
    if not name.startswith(PORTS):
        return
    if not any(process.name == MODEM_MANAGER for process in machine.processes()):
        yield ok('ModemManager', 'does not run')
        return
    number = machine.read(f'/sys/class/tty/{name}/dev')
    marks = (machine.read(f'/run/udev/data/c{number}') or '').splitlines()
    if any(mark in marks for mark in ('E:ID_MM_DEVICE_IGNORE=1', 'E:ID_MM_PORT_IGNORE=1')):
        yield ok('ModemManager', 'runs, and leaves this port alone')
    else:
        yield problem('ModemManager', 'runs, and may take the device for a modem and write to it '
                                      'whenever it is plugged in', install_rule(rule))


def _latency(machine: Machine, device: str) -> Iterator[CheckResult]:
    file = f'/sys/bus/usb-serial/devices/{os.path.basename(device)}/latency_timer'
    timer = machine.read(file)
    if timer is None:
        return
    if timer == '1':
        yield ok('latency timer', 'is 1 ms')
    else:
        yield advice('latency timer', f'is {timer} ms: data arrives up to {timer} ms late; '
                                      'stamps are not affected',
                     f'echo 1 | sudo tee {shlex.quote(file)}')


def check_name(machine: Machine, port: str, rule: str,
               make_command: Callable[[str], str] = run_driver) -> Iterator[CheckResult]:
    """Check whether a port has a stable name; make_command starts a driver on a port."""
    device = machine.resolved(port)
    if not os.path.basename(device).startswith(PORTS) or not os.path.exists(machine.path(port)):
        return
    if port != device:
        yield ok('name', 'does not change when devices are plugged in in another order')
        return
    stable = [name for name in machine.names(BY_ID) if machine.resolved(name) == device]
    if stable:
        yield advice('name', f'{port} may name another device after replugging: {stable[0]} '
                             'always names this one', make_command(stable[0]))
    else:
        yield advice('name', f'{port} may name another device after replugging, and it has no '
                             'stable name', install_rule(rule))
