# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of what the doctor hears on a port."""

from bahrs_driver.doctor import listening
from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.listening import check, ProbeResult
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.processes import running, wait_for


def test_a_device_that_speaks():
    """Version and rate are reported; nothing is written to the port."""
    with PtyPort() as cable, Device(cable):
        found = list(check(cable.path, 115200, seconds=30.0))
    assert [result.level for result in found] == [Level.OK]
    assert 'a BAHRS of protocol version 3 sends at 115200 baud' in found[0].message


def test_silence():
    """The message names what to check."""
    with PtyPort() as cable:
        found = list(check(cable.path, 115200, seconds=0.2))
    assert [result.level for result in found] == [Level.PROBLEM]
    assert 'nothing arrives' in found[0].message


def test_no_port():
    """The message has the reason of the link."""
    (result,) = check('/dev/does_not_exist', 115200)
    assert result.level is Level.PROBLEM and 'does not exist' in result.message


@pytest.fixture
def probed(monkeypatch):
    """Return a list of the rates listened at; frames come only at the rate that is set."""
    rates = []

    def probe(port, rate, seconds, ask):
        rates.append(rate)
        if rate != probed.sends_at:
            return ProbeResult(rate, 900)
        return ProbeResult(rate, 900, 'BAHRS of protocol version 2', 'bahrs', 20, 0)

    def probed():
        return rates

    probed.sends_at = 0
    monkeypatch.setattr(listening, 'probe', probe)
    return probed


def test_another_rate(probed):
    """It is found, and the command has it."""
    probed.sends_at = 57600
    wrong, right = check('/dev/ttyUSB0', 115200)
    assert wrong.level is Level.PROBLEM and wrong.command.endswith('-p baud_rate:=57600')
    assert right.level is Level.OK and 'version 2 sends at 57600' in right.message


def test_another_device(probed):
    """All rates are tried, each once."""
    (result,) = check('/dev/ttyUSB0', 115200)
    assert result.level is Level.PROBLEM and 'no frame of a BAHRS' in result.message
    assert sorted(probed()) == sorted(listening.BAUD_RATES)


def test_a_device_that_answers(tmp_path):
    """A Titan-M must be asked, and is asked only with the option."""
    port = str(tmp_path / 'port')
    with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', port) as emulator:
        assert wait_for(lambda: emulator.lines, 60)
        (silent,) = check(port, 115200, seconds=0.5)
        assert silent.command == f'bahrs doctor --port {port} --ask'
        (found,) = check(port, 115200, seconds=30.0, ask=True)
    assert found.level is Level.OK and 'a Titan-M answers at 115200 baud' in found.message


def test_what_was_heard_is_returned(probed):
    """For the commands that follow."""
    probed.sends_at = 57600
    found = []

    def note():
        found.append((yield from check('/dev/ttyUSB0', 115200)))

    assert len(list(note())) == 2
    assert (found[0].sensor, found[0].baud_rate) == ('bahrs', 57600)
