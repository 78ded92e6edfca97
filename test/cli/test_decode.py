# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs decode`, as a process."""

import csv
import json
import os
import pty
import shlex
from signal import SIGKILL
import subprocess
import tempfile

from bahrs_driver.cli.main import main
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, build_frame
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, HardwareVersion, Inertial, InertialTime, Navigation, NavigationTime, NvmPage,
    SoftwareVersion, SyncPulseTime,
)
from bahrs_driver.protocol.integrity import Integrity
from hypothesis import given, HealthCheck, settings, strategies as st
import pytest
from support.bags import every_form
from support.processes import command, PATIENCE, wait_for
from support.shared_files import shared_file

SAFE, RISK, GONE = Integrity.SAFE, Integrity.INTEGRITY_RISK, Integrity.UNAVAILABLE
MESSAGES = [
    SoftwareVersion('OSS', 1, 2),
    HardwareVersion(7, (1, 2, 3)),
    Inertial(3, (0.0014964, 0.0, -9.7266), (0.0, 0.0, 0.0), (SAFE, RISK, GONE, SAFE, SAFE, SAFE)),
    InertialTime(0, 4, 5000),
    Navigation(1, 5187.59438336, -0.9155413, 0.0, 0.0, 3.0, (SAFE,) * 5),
    Accuracy(0, 0.01, None, 0.02, 5000),
    NvmPage(9, bytes(range(32))),
]
EVERY_BYTE = b''.join(
    BahrsCodec().encode(NvmPage(index, bytes(range(32 * index, 32 * index + 32))), 3)
    for index in range(8))
STREAM = b''.join(BahrsCodec().encode(message, 3) for message in MESSAGES)


def decode(*words, data=None):
    """Run the verb; return its output, its errors and its exit status."""
    done = subprocess.run(command('bahrs', 'decode', *words),
                          input=data, capture_output=True, check=False)
    return done.stdout.decode(), done.stderr.decode(), done.returncode


def summary(text):
    """Return the summary as a dictionary."""
    return {line[:22].strip(): line[22:].strip() for line in text.splitlines()}


def lines(path):
    """Return the number of lines of a file."""
    return path.read_bytes().count(b'\n')


def test_the_example_with_a_port(tmp_path):
    """The command in --help sets the port to raw mode; other ports are refused."""
    ours, theirs = pty.openpty()
    with os.fdopen(ours, 'wb', buffering=0) as device, os.fdopen(theirs) as far_end:
        port = os.ttyname(far_end.fileno())
        for words, data in (([port], None), (['-'], far_end)):
            done = subprocess.run(command('bahrs', 'decode', *words), stdin=data, text=True,
                                  capture_output=True, timeout=PATIENCE, check=False)
            assert done.returncode == 1 and 'is not in raw mode' in done.stderr
        shown = decode('--help')[0]
        example = next(line for line in shown.splitlines() if '/dev/ttyUSB0' in line)
        script = example.replace('/dev/ttyUSB0', port).replace(
            'bahrs ', shlex.join(command('bahrs')) + ' ').replace('flight', f'{tmp_path}/flight')
        rows = tmp_path / 'flight.csv'
        shell = subprocess.Popen(['sh', '-c', script], stderr=subprocess.PIPE,
                                 start_new_session=True,
                                 env={**os.environ, 'PYTHONUNBUFFERED': '1'})
        try:
            # The heading comes when the port has been set and is open.
            assert wait_for(lambda: rows.exists() and lines(rows) == 1)
            device.write(EVERY_BYTE)
            # What is not read yet when the device goes would be lost.
            assert wait_for(lambda: lines(rows) == 9)
            device.close()
            _, error = shell.communicate(timeout=PATIENCE)
            assert (shell.returncode, error) == (0, b'')
        finally:
            if shell.poll() is None:
                os.killpg(shell.pid, SIGKILL)
    assert rows.read_text() == decode('--format', 'csv', '-', data=EVERY_BYTE)[0]


def test_jsonl_has_one_line_per_message_in_si():
    """Each has name, version, offset, sequence if the frame has one, and all fields."""
    out, err, status = decode('--format', 'jsonl', '-', data=STREAM)
    rows = [json.loads(line) for line in out.splitlines()]
    assert (status, err) == (0, '')
    assert [row['message'] for row in rows] == [message.NAME for message in MESSAGES]
    assert all(row['version'] == 3 for row in rows)
    assert rows[0] == {'message': 'software_version', 'version': 3, 'offset': 0,
                       'project': 'OSS', 'major': 1, 'minor': 2}
    assert rows[1]['unique_id'] == [1, 2, 3]
    assert rows[2]['specific_force'] == pytest.approx([0.0014964, 0.0, -9.7266])
    assert rows[2]['health'] == ['safe', 'integrity_risk', 'unavailable', 'safe', 'safe', 'safe']
    assert (rows[2]['offset'], rows[2]['sequence']) == (44, 3)
    assert rows[3]['valid'] is True and rows[3]['device_time_us'] == 5000
    assert rows[5]['east_std'] is None
    assert rows[6]['data'] == bytes(range(32)).hex()


def test_csv_has_one_row_per_message_and_one_column_per_field():
    """Vectors have a column per axis, integrity one per signal; other cells are empty."""
    out, _, _ = decode('--format', 'csv', '-', data=STREAM)
    rows = list(csv.DictReader(out.splitlines()))
    assert len(rows) == len(MESSAGES)
    assert float(rows[2]['specific_force_x']) == pytest.approx(0.0014964)
    assert rows[2]['specific_force_z'] == ''
    assert rows[2]['specific_force_y_integrity'] == 'integrity_risk'
    assert rows[2]['pressure_height'] == ''
    assert float(rows[4]['pressure_height']) == pytest.approx(5187.59, abs=0.01)
    assert rows[5]['east_std'] == '' and float(rows[5]['heading_std']) == pytest.approx(0.02, 1e-2)


def in_process(capsys, stream, *words):
    """Run the verb on a stream in this process; return the printed rows."""
    with tempfile.NamedTemporaryFile() as file:
        file.write(stream)
        file.flush()
        assert main(['decode', '--format', 'csv', *words, file.name]) == 0
    return list(csv.DictReader(capsys.readouterr().out.splitlines()))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(inertial=st.tuples(*[st.sampled_from(Integrity)] * 6),
       navigation=st.tuples(*[st.sampled_from(Integrity)] * 5))
def test_csv_has_empty_cells_for_unavailable_values(capsys, inertial, navigation):
    """Each signal is emptied alone; its integrity has its own column."""
    messages = (Inertial(3, (1.0, 2.0, -9.8), (0.1, 0.2, 0.3), inertial),
                Navigation(1, 100.0, -0.5, 0.1, 0.2, 3.0, navigation))
    rows = in_process(capsys, b''.join(BahrsCodec().encode(item, 3) for item in messages))
    for row, message in zip(rows, messages, strict=True):
        for signal, integrity in zip(message.SIGNALS, message.health):
            assert row[f'{signal}_integrity'] == integrity.label
            assert bool(row[signal]) == integrity.available
            assert not row[signal] or float(row[signal]) != 0


def test_csv_has_the_time_of_each_message():
    """In the recording, a pause before the second time message has no time."""
    out, _, _ = decode('--format', 'csv', str(shared_file('data/bahrs_recording_v2.bin')))
    rows = list(csv.DictReader(out.splitlines()))
    for message, period in (('inertial', 5000), ('navigation', 10_000)):
        times = [row['device_time_us'] for row in rows if row['message'] == message]
        known = [int(time) for time in times[25:]]
        assert len(known) == len(times) - 25
        assert all(abs(later - sooner - period) <= 2 for sooner, later in zip(known, known[1:]))
    data = [row for row in rows if row['message'] in ('inertial', 'inertial_time')]
    for sample, time in zip(data, data[1:]):
        if time['message'] == 'inertial_time' and sample['device_time_us']:
            assert time['device_time_us'] == sample['device_time_us']
    assert list(rows[0])[1] == 'device_time_us'


def test_csv_has_no_unknown_time(capsys):
    """A device without a time sends zeros."""
    messages = (NavigationTime(0, 0, 0), InertialTime(0, 0, 5000),
                Accuracy(0, None, None, None, 0),
                SyncPulseTime(0, 77))
    rows = in_process(capsys, b''.join(BahrsCodec().encode(item, 3) for item in messages))
    assert [row['device_time_us'] for row in rows] == ['', '5000', '', '77']
    assert [row['reference_sequence'] for row in rows] == ['', '0', '', '']


def test_summary_counts():
    """It counts messages, unknown types and damage, and has detected properties."""
    unknown = build_frame(3, 0xC1, bytes(9), 'word')
    damaged = STREAM[44:54] + b'?' + STREAM[55:72]
    out, _, status = decode('-', data=STREAM + unknown + damaged + STREAM)
    rows = summary(out)
    assert status == 0
    assert rows['inertial'] == '2' and rows['unknown type 0xC1'] == '1'
    assert rows['CRC failures'] == '1' and rows['skipped bytes'] == '28'
    assert rows['protocol version'] == '3' and rows['CRC order'] == 'word'


def test_pressure_height_format():
    """Above 4,500 m the signed value is 11,000 m lower."""
    out, _, _ = decode('--format', 'jsonl', '--pressure-height', 'int16', '-', data=STREAM)
    height = json.loads(out.splitlines()[4])['pressure_height']
    assert height == pytest.approx(5187.59 - 65536 * 0.16784924, abs=0.01)


@pytest.mark.parametrize('words, data, status, sentence', [
    (['nowhere.bin'], None, 1, 'bahrs decode: cannot read nowhere.bin: No such file'),
    (['/'], None, 1, 'bahrs decode: cannot read /: Is a directory'),
    (['-'], b'', 1, 'bahrs decode: no frame of a bahrs in 0 bytes; '
     'if they are of another device, try --sensor titan_m'),
    (['-'], b'NENENENE' * 9, 1, 'bahrs decode: no frame of a bahrs in 72 bytes; '
     'if they are of another device, try --sensor titan_m'),
    (['--format', 'xml', '-'], b'', 2, "invalid choice: 'xml'"),
])
def test_errors(words, data, status, sentence):
    """The message is one sentence, and the exit status is not 0."""
    _, err, found = decode(*words, data=data)
    assert found == status and sentence in err and 'Traceback' not in err


def test_a_bag_is_not_decoded(tmp_path):
    """The message names the verbs that read it."""
    for file in every_form(tmp_path):
        out, err, status = decode('--format', 'jsonl', str(file))
        assert (status, out) == (1, '') and 'is a bag: ' in err and 'bahrs convert' in err


def test_a_closed_output():
    """The reader of a pipe may close it early, as head does."""
    line = shlex.join(command('bahrs', 'decode', '--format', 'jsonl', '-')) + ' | head -n 1'
    done = subprocess.run(line, shell=True, input=STREAM * 3000, capture_output=True,
                          check=False)
    assert done.stdout.count(b'\n') == 1 and done.stderr == b''


def test_a_recording():
    """All frames of the real device are decoded."""
    out, _, status = decode(str(shared_file('data/bahrs_recording_v2.bin')))
    assert status == 0
    assert summary(out) == {
        'inertial': '47,837', 'navigation': '23,919', 'accuracy': '2,392',
        'navigation_time': '2,392', 'inertial_time': '2,392', 'bytes': '1,884,800',
        'CRC failures': '0', 'skipped bytes': '0', 'protocol version': '2', 'CRC order': 'word'}
