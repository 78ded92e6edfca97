# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the detection of a device on a port."""

from bahrs_driver.doctor import listening
from bahrs_driver.doctor.check_result import Level
from bahrs_driver.doctor.listening import check, ProbeResult
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.processes import running, wait_for


def test_a_streaming_device():
    """The result has protocol version and baud rate."""
    with PtyPort() as cable, Device(cable):
        found = list(check(cable.path, 115200, seconds=30.0))
    assert [result.level for result in found] == [Level.OK]
    assert 'a BAHRS of protocol version 3 sends at 115200 baud' in found[0].message


def test_a_silent_port():
    """It is a problem."""
    with PtyPort() as cable:
        found = list(check(cable.path, 115200, seconds=0.2))
    assert [result.level for result in found] == [Level.PROBLEM]
    assert 'nothing arrives' in found[0].message


def test_a_missing_port():
    """The message has the error of the link."""
    (result,) = check('/dev/does_not_exist', 115200)
    assert result.level is Level.PROBLEM and 'does not exist' in result.message


@pytest.fixture
def probed(monkeypatch):
    """Fake the probes: frames arrive only at the rate sends_at. Return the probed rates."""
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


def test_another_baud_rate(probed):
    """It is detected, and the command sets it."""
    probed.sends_at = 57600
    wrong, right = check('/dev/ttyUSB0', 115200)
    assert wrong.level is Level.PROBLEM and wrong.command.endswith('-p baud_rate:=57600')
    assert right.level is Level.OK and 'version 2 sends at 57600' in right.message


def test_another_device(probed):
    """All rates are tried once."""
    (result,) = check('/dev/ttyUSB0', 115200)
    assert result.level is Level.PROBLEM and 'no frame of a BAHRS' in result.message
    assert sorted(probed()) == sorted(listening.BAUD_RATES)


def test_a_device_that_only_answers(tmp_path):
    """Requests are sent only with the option."""
    port = str(tmp_path / 'port')
    with running('bahrs', 'emulate', '--sensor', 'titan_m', '--link', port) as emulator:
        assert wait_for(lambda: emulator.lines, 60)
        (silent,) = check(port, 115200, seconds=0.5)
        assert silent.command == f'bahrs doctor --port {port} --ask'
        (found,) = check(port, 115200, seconds=30.0, ask=True)
    assert found.level is Level.OK and 'a Titan-M answers at 115200 baud' in found.message


def test_the_probe_is_returned(probed):
    """Later commands need it."""
    probed.sends_at = 57600
    found = []

    def collect():
        found.append((yield from check('/dev/ttyUSB0', 115200)))

    assert len(list(collect())) == 2
    assert (found[0].sensor, found[0].baud_rate) == ('bahrs', 57600)
