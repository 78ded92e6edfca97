# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Is the port there, may it be opened, who has it, and how is its adapter set up."""

from collections.abc import Callable, Iterator
import os
import shlex
import stat

from bahrs_driver.doctor.commands import run_doctor, run_driver
from bahrs_driver.doctor.finding import advice, Finding, good, problem
from bahrs_driver.doctor.machine import Machine

PORTS = ('ttyUSB', 'ttyACM')
BY_ID = '/dev/serial/by-id'
RULE = '99-bahrs.rules'
RULES_FOLDERS = ('/etc/udev/rules.d', '/run/udev/rules.d', '/usr/lib/udev/rules.d',
                 '/lib/udev/rules.d')
DRIVERS = {'0403': 'ftdi_sio', '10c4': 'cp210x', '1a86': 'ch341', '067b': 'pl2303'}
OUR_DRIVER = 'driver_node'


def install_rule(rule: str) -> str:
    """Return the command that installs the udev rule, found at a path."""
    return (f'sudo cp {shlex.quote(rule)} /etc/udev/rules.d/ && sudo udevadm control --reload && '
            'sudo udevadm trigger')


def candidates(machine: Machine) -> list[str]:
    """Return the ports of USB adapters, by their stable names where they have one."""
    stable = {machine.resolved(name): name for name in machine.names(BY_ID)}
    return [stable.get(name, name) for name in machine.names('/dev')
            if os.path.basename(name).startswith(PORTS)]


def look(machine: Machine, port: str, rule: str) -> Iterator[Finding]:
    """Yield findings about a port that is a path; rule is where the udev rule is."""
    yield from look_at_port(machine, port, rule)
    yield from look_at_name(machine, port, rule)


def look_at_port(machine: Machine, port: str, rule: str) -> Iterator[Finding]:
    """Yield whether a port is there, may be opened and is free, and how its adapter is set up."""
    try:
        info = os.stat(machine.path(port))
    except PermissionError:
        yield problem('access', f'user {machine.user.name} may not look into the folder of '
                                f'{port}', f'namei -l {shlex.quote(port)}')
        return
    except OSError:
        yield _missing(machine, port)
        return
    device = machine.resolved(port)
    yield good('port', f'{port} is there' + (f' ({device})' if device != port else ''))
    yield _access(machine, port, info)
    yield from _busy(machine, port, device)
    yield from _modem_manager(machine, device, rule)
    yield from _latency(machine, device)


def _missing(machine: Machine, port: str) -> Finding:
    others = candidates(machine)
    if others:
        return problem('port', f'{port} does not exist, but {", ".join(others)} does',
                       run_doctor(others[0]))
    for name in machine.names('/sys/bus/usb/devices'):
        driver = DRIVERS.get(machine.read(f'{name}/idVendor') or '')
        if driver:
            return _no_tty(machine, port, driver)
    return problem('port', f'{port} does not exist, nor any adapter on USB: plug it in and watch '
                           'what the kernel says', 'sudo dmesg --follow')


def _no_tty(machine: Machine, port: str, driver: str) -> Finding:
    rules = [name for folder in RULES_FOLDERS for name in machine.names(folder)]
    if any('brltty' in os.path.basename(name) for name in rules):
        return problem('port', f'{port} does not exist: an adapter is on USB, but brltty takes it '
                               'for a Braille display', 'sudo apt remove brltty')
    return problem('port', f'{port} does not exist: an adapter is on USB, but its kernel module '
                           f'{driver} made no port of it', f'sudo modprobe {driver}')


def _access(machine: Machine, port: str, info: os.stat_result) -> Finding:
    user, mode = machine.user, info.st_mode
    group = machine.group_name(info.st_gid)
    group_may = stat.S_IRGRP & mode and stat.S_IWGRP & mode
    everybody_may = stat.S_IROTH & mode and stat.S_IWOTH & mode
    if user.uid == 0 or everybody_may or (user.uid == info.st_uid and mode & stat.S_IRUSR) \
            or (group_may and info.st_gid in user.groups):
        return good('access', f'user {user.name} may open it')
    if not group_may:
        return problem('access', f'user {user.name} may not open {port}: its mode is '
                                 f'{stat.filemode(mode)}',
                       f'sudo chgrp dialout {shlex.quote(port)} && '
                       f'sudo chmod 660 {shlex.quote(port)}')
    if machine.is_member(info.st_gid):
        return problem('access', f'user {user.name} is in group {group}, but was not when this '
                                 'session began: log in again, or go on in another shell',
                       f'newgrp {shlex.quote(group)}')
    return problem('access', f'user {user.name} may not open {port}: it belongs to group {group}; '
                             'join it and log in again',
                   f'sudo usermod -aG {shlex.quote(group)} {shlex.quote(user.name)}')


def _busy(machine: Machine, port: str, device: str) -> Iterator[Finding]:
    holders = machine.holders(device)
    for process in holders:
        said = f'{port} is open in {process.name} (process {process.pid})'
        if process.name == OUR_DRIVER:
            yield good('in use', f'{said}: the driver runs')
        elif process.name == 'ModemManager':
            yield problem('in use', said, 'sudo systemctl stop ModemManager')
        else:
            yield problem('in use', said, f'kill {process.pid}')
    if not holders and machine.all_visible():
        yield good('in use', 'no other process has it open')
    elif not holders:
        yield good('in use', f'no process of user {machine.user.name} has it open; others are '
                             'not to be seen')


def _modem_manager(machine: Machine, device: str, rule: str) -> Iterator[Finding]:
    name = os.path.basename(device)
    if not name.startswith(PORTS):
        return
    if not any(process.name == 'ModemManager' for process in machine.processes()):
        yield good('ModemManager', 'does not run')
        return
    number = machine.read(f'/sys/class/tty/{name}/dev')
    marks = (machine.read(f'/run/udev/data/c{number}') or '').splitlines()
    if any(mark in marks for mark in ('E:ID_MM_DEVICE_IGNORE=1', 'E:ID_MM_PORT_IGNORE=1')):
        yield good('ModemManager', 'runs, and leaves this port alone')
    else:
        yield problem('ModemManager', 'runs, and may take the device for a modem and write to it '
                                      'whenever it is plugged in', install_rule(rule))


def _latency(machine: Machine, device: str) -> Iterator[Finding]:
    file = f'/sys/bus/usb-serial/devices/{os.path.basename(device)}/latency_timer'
    timer = machine.read(file)
    if timer is None:
        return
    if timer == '1':
        yield good('latency timer', 'is 1 ms')
    else:
        yield advice('latency timer', f'is {timer} ms: data comes so much later than it could; '
                                      'stamps do not suffer',
                     f'echo 1 | sudo tee {shlex.quote(file)}')


def look_at_name(machine: Machine, port: str, rule: str,
                 run: Callable[[str], str] = run_driver) -> Iterator[Finding]:
    """Yield whether a port has a stable name; run is the command that starts a driver on one."""
    device = machine.resolved(port)
    if not os.path.basename(device).startswith(PORTS) or not os.path.exists(machine.path(port)):
        return
    if port != device:
        yield good('name', 'does not change when devices are plugged in in another order')
        return
    stable = [name for name in machine.names(BY_ID) if machine.resolved(name) == device]
    if stable:
        yield advice('name', f'{port} may be another device after the next plug: {stable[0]} is '
                             'always this one', run(stable[0]))
    else:
        yield advice('name', f'{port} may be another device after the next plug, and it has no '
                             'stable name', install_rule(rule))
