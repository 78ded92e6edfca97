# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of control commands, scenarios and ground truth."""

import io
import json

from bahrs_driver.emulator.control import execute, validate
from bahrs_driver.emulator.scenario import parse, TimedCommand
from bahrs_driver.emulator.session import EmulationSession
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.emulator.truth_file import TruthFile
from bahrs_driver.errors import ControlError, ScenarioError
from bahrs_driver.protocol.bahrs.messages import Inertial, Navigation, SoftwareVersion
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.virtual_serial.cable import PACKETS
import pytest
from support.emulated import decoded, make_device, make_emulation, on_the_wire

SAFE, RISK, UNAVAILABLE = Integrity.SAFE, Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE


def after(*lines, now=1.0):
    """Return an emulation after some commands at a time."""
    emulation = make_emulation()
    on_the_wire(emulation, now)
    for line in lines:
        execute(line, emulation, now)
    return emulation


def last(emulation, kind, until=2.0):
    """Return the last message of a kind up to a time."""
    _, data = on_the_wire(emulation, until)
    return [message for message in decoded(data) if isinstance(message, kind)][-1]


def test_one_signal_at_risk():
    """The other signals do not change."""
    message = last(after('integrity roll risk'), Navigation)
    assert message.health == (SAFE, SAFE, RISK, SAFE, SAFE)


def test_integrity_of_a_quantity_and_of_all_signals():
    """A quantity stands for its components, `all` for every signal."""
    assert last(after('integrity specific_force unavailable'), Inertial).health == (
        UNAVAILABLE, UNAVAILABLE, UNAVAILABLE, SAFE, SAFE, SAFE)
    everything = after('integrity all risk', 'integrity angular_rate_z safe')
    assert last(everything, Inertial).health == (RISK,) * 5 + (SAFE,)
    assert last(everything, Navigation, 3.0).health == (RISK,) * 5


def test_faults_and_timer_change():
    """Commands change both in a running emulation."""
    emulation = after('fault drop_frame=1', 'latency-timer packets')
    assert emulation.cable.mode == PACKETS
    sent, data = on_the_wire(emulation, 2.0)
    assert sent and {item.fate for item in sent} == {'dropped'} and not data
    assert emulation.faults.counts['drop_frame'] == len(sent)


def test_power_cycle():
    """The device sends its version again."""
    assert isinstance(last(after('power-cycle'), SoftwareVersion), SoftwareVersion)


def test_unplug():
    """Frames sent meanwhile are lost, and their fate says so; later frames arrive."""
    emulation = after('unplug 0.5')
    assert not emulation.plugged(1.4) and emulation.plugged(1.5)
    sent, data = on_the_wire(emulation, 1.4)
    assert {item.fate for item in sent} == {'unplugged'} and not data
    sent, data = on_the_wire(emulation, 3.0)
    assert len(decoded(data)) == sum(item.fate == 'intact' for item in sent) > 0


def test_drift_and_pulses():
    """The commands reach the device."""
    emulation = after('drift-ppm -50', 'sync-pulse-rate 5', now=1.1)
    assert emulation.device.clock.drift_ppm == -50.0
    sent, _ = on_the_wire(emulation, 3.11)
    assert sum(item.emission.name == 'sync_pulse_time' for item in sent) == 10


def test_quit():
    """The command sets a flag that ends the run."""
    assert after('quit').ended and not after().ended


def test_empty_lines_and_comments_do_nothing():
    """Neither changes anything."""
    after('', '   ', '# integrity all risk')


@pytest.mark.parametrize(('line', 'says'), [
    ('explode', "no command 'explode', only integrity, fault"),
    ('integrity roll', 'write "integrity SIGNAL STATE"'),
    ('integrity yaw risk', "no signal 'yaw', only all, specific_force_x"),
    ('integrity roll bad', "no integrity 'bad', only safe, risk"),
    ('fault rust=1', "no fault 'rust', only bit_flip"),
    ('fault bit_flip', "the rate of bit_flip is ''"),
    ('latency-timer 0', 'from 1 to 255'),
    ('unplug soon', "'soon': it must be a number of at least 0"),
    ('power-cycle now', 'write "power-cycle"'),
    ('drift-ppm fast', 'from -100000 to 100000'),
    ('sync-pulse-rate -1', 'from 0 to 1000'),
])
def test_an_invalid_line_is_rejected(line, says):
    """The error is one sentence, and nothing changes."""
    with pytest.raises(ControlError, match=says) as caught:
        after(line)
    assert '\n' not in str(caught.value)


def test_commands_of_a_scenario_are_sorted_by_time():
    """The lines may have any order."""
    text = '20 integrity roll safe\n\n# a comment\n 12.5  integrity roll risk  # here\n'
    assert parse(text.splitlines()) == [
        TimedCommand(12.5, 'integrity roll risk'), TimedCommand(20.0, 'integrity roll safe')]


@pytest.mark.parametrize(('line', 'says'), [
    ('integrity roll risk', 'line 2 .*must be seconds and a command'), ('5', 'line 2'),
    ('-1 quit', 'line 2'), ('inf quit', 'line 2'), ('5 explode', "line 2: .*no command 'explode'"),
    ('5 integrity roll', 'line 2: .*write "integrity SIGNAL STATE"')])
def test_an_invalid_scenario_is_rejected_before_it_starts(line, says):
    """The error has the number of the line."""
    with pytest.raises(ScenarioError, match=says):
        parse(['# first', line])


def test_validation_needs_no_emulation():
    """It finds errors that do not depend on the device."""
    validate('quit')
    with pytest.raises(ControlError):
        validate('quit now')


def test_commands_of_a_scenario_are_executed_at_their_times():
    """Commands take effect with the next sample, and the truth file contains them."""
    file = io.StringIO()
    scenario = parse(['1.005 integrity roll risk', '2.005 integrity roll safe',
                      '2.505 unplug 0.2'])
    session = EmulationSession(make_emulation(make_device()), scenario, TruthFile(file))
    session.advance(3.0, StartTime(100, 2000))
    messages = decoded(session.emulation.take(9.0))
    states = [message.health[2] for message in messages if isinstance(message, Navigation)]
    # Samples are at 0.60, 0.61, ... s; eight of them come before alignment.
    assert states[8:155] == [SAFE] * 33 + [RISK] * 100 + [SAFE] * 14
    lines = [json.loads(line) for line in file.getvalue().splitlines()]
    events = [line for line in lines if 'event' in line]
    assert events[0] == {'event': 'integrity roll risk', 'host_monotonic_ns': 1_005_000_100,
                         'host_unix_ns': 1_005_002_000}
    first_unplugged = next(line for line in lines if line.get('wire') == 'unplugged')
    assert first_unplugged['host_monotonic_ns'] == pytest.approx(2_505_000_100, abs=5_000_001)


def test_a_line_of_truth():
    """A line has message, times by all clocks, fate and true values."""
    file = io.StringIO()
    session = EmulationSession(make_emulation(make_device()), (), TruthFile(file))
    session.advance(0.6, StartTime(10, 20))
    lines = [json.loads(line) for line in file.getvalue().splitlines()]
    inertial = next(line for line in lines if line['message'] == 'inertial')
    assert inertial == {
        'message': 'inertial', 'host_monotonic_ns': 600_000_010, 'host_unix_ns': 600_000_020,
        'device_time_us': 600_000, 'specific_force': [0.0, 0.0, -9.80665],
        'angular_rate': [0.0, 0.0, 0.0], 'sequence': 0, 'wire': 'intact'}
    navigation = next(line for line in lines if line['message'] == 'navigation')
    assert set(navigation) >= {'pressure_height', 'velocity_down', 'roll', 'pitch',
                               'magnetic_heading', 'sequence', 'device_time_us'}


def test_the_truth_file_can_be_read_while_it_is_written(tmp_path):
    """The file is flushed twice a second."""
    with open(tmp_path / 'truth', 'w') as file:
        session = EmulationSession(make_emulation(make_device()), (), TruthFile(file))
        session.advance(5.0, StartTime())
        last_line = (tmp_path / 'truth').read_text().splitlines()[-2]
    assert json.loads(last_line)['host_monotonic_ns'] > 4_400_000_000


def test_a_slow_line_loses_frames():
    """The line transmits as many bytes as its baud rate allows."""
    emulation = make_emulation(make_device(debug_rate=200.0))
    sent, data = on_the_wire(emulation, 20.0)
    kept = [item for item in sent if item.fate == 'intact']
    assert {item.fate for item in sent} == {'intact', 'overrun'}
    assert emulation.fate_counts['overrun'] == len(sent) - len(kept)
    assert data == b''.join(item.emission.data for item in kept)
    assert len(data) == pytest.approx(11520 * 19.4, rel=0.02)
