# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The control commands of a running emulation, one per line."""

from collections.abc import Callable
from typing import NamedTuple

from bahrs_driver.emulator.emulation import Emulation
from bahrs_driver.errors import ControlError
from bahrs_driver.process.text_values import known, number
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.virtual_serial.cable import adapter_mode
from bahrs_driver.virtual_serial.faults import parse_fault

INTEGRITIES = {'safe': Integrity.SAFE, 'risk': Integrity.INTEGRITY_RISK,
               'unavailable': Integrity.UNAVAILABLE, 'reserved': Integrity.RESERVED}


class Command(NamedTuple):
    """A command: its arguments, a summary for the help, and its function."""

    arguments: str
    summary: str
    run: Callable[[Emulation, float, list[str]], None]


def execute(line: str, emulation: Emulation, now: float) -> None:
    """Execute a line; ControlError if it is invalid. Empty lines and # comments do nothing."""
    parsed = _parse(line)
    if parsed is None:
        return
    command, words = parsed
    try:
        command.run(emulation, now, words)
    except ValueError as error:
        raise ControlError(str(error)) from error


def validate(line: str) -> None:
    """Raise ControlError if a line is not a command with the right number of arguments."""
    _parse(line)


def _parse(line: str) -> tuple[Command, list[str]] | None:
    """Return a command and its arguments; None if the line is empty."""
    name, *words = line.split('#')[0].split() or ['']
    if not name:
        return None
    try:
        command = COMMANDS[known(name, 'command', COMMANDS)]
    except ValueError as error:
        raise ControlError(str(error)) from error
    if len(words) != len(command.arguments.split()):
        usage = f'{name} {command.arguments}'.strip()
        raise ControlError(f'{line.strip()!r} is invalid: write "{usage}"')
    return command, words


def _integrity(emulation: Emulation, _now: float, words: list[str]) -> None:
    name, state = words
    integrity = INTEGRITIES[known(state, 'integrity', INTEGRITIES)]
    names = emulation.device.signals
    chosen = names if name == 'all' else tuple(
        signal for signal in names if signal == name or signal.startswith(name + '_'))
    emulation.device.set_integrity(chosen or (known(name, 'signal', ('all', *names)),), integrity)


def _fault(emulation: Emulation, _now: float, words: list[str]) -> None:
    emulation.faults.set_rate(*parse_fault(words[0]))


def _latency_timer(emulation: Emulation, _now: float, words: list[str]) -> None:
    emulation.cable.mode = adapter_mode(words[0])


def _unplug(emulation: Emulation, now: float, words: list[str]) -> None:
    emulation.unplug(now, number(words[0], 'the time without a plug in seconds'))


def _power_cycle(emulation: Emulation, now: float, _words: list[str]) -> None:
    emulation.device.power_cycle(now)


def _drift(emulation: Emulation, _now: float, words: list[str]) -> None:
    emulation.device.set_drift(number(words[0], 'the drift in ppm', -1e5, 1e5))


def _sync_pulse_rate(emulation: Emulation, _now: float, words: list[str]) -> None:
    emulation.device.set_pulse_rate(number(words[0], 'the rate of sync pulses in Hz', 0, 1000))


def _quit(emulation: Emulation, _now: float, _words: list[str]) -> None:
    emulation.ended = True


COMMANDS = {
    'integrity': Command('SIGNAL STATE', 'safe, risk, unavailable or reserved; SIGNAL may be '
                         'all or specific_force', _integrity),
    'fault': Command('NAME=RATE', 'change the rate of a fault', _fault),
    'latency-timer': Command('MS', 'change the latency timer; also packets, none',
                             _latency_timer),
    'unplug': Command('SECONDS', 'take the port away and bring it back', _unplug),
    'power-cycle': Command('', 'switch the device off and on again', _power_cycle),
    'drift-ppm': Command('PPM', 'change the drift of the device clock', _drift),
    'sync-pulse-rate': Command('HZ', 'change the rate of sync pulses; 0 is none',
                               _sync_pulse_rate),
    'quit': Command('', 'end the emulator', _quit),
}
