# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the verbs on a Titan-M, as processes."""

import csv
import dataclasses
import json
import math
import subprocess

from bahrs_driver.protocol.titan_m.frames import build_answer
from bahrs_driver.protocol.titan_m.messages import Gps, State
import pytest
from support.processes import command
from support.shared_files import shared_file

STATE = State((1.0, 2.0, -3.0), (0.5, -0.25, 0.0), (0.125, -0.5, 1.5), (0.0, 0.0625, -1.0))
NOTHING = State(*[(0.0,) * 3] * 4)


def run(verb, *words, data=None):
    """Run a verb; return its output, its errors and its exit status."""
    done = subprocess.run(command('bahrs', verb, '--sensor', 'titan_m', *words),
                          input=data, capture_output=True, check=False)
    assert b'Traceback' not in done.stderr
    return done.stdout.decode(), done.stderr.decode(), done.returncode


def test_jsonl_of_vectors():
    """All vectors of a payload order are in one stream, with both values of LEN."""
    vectors = [vector for vector in json.loads(shared_file('vectors/frames.json').read_text())
               if vector['device'] == 'titan_m' and 'request' not in vector['message']]
    for payload in '<>':
        chosen = [vector for vector in vectors if vector['payload_order'] == payload
                  and vector['checksum_order'] == '>']
        stream = b''.join(bytes.fromhex(vector['hex']) for vector in chosen)
        out, err, status = run('decode', '--format', 'jsonl', '-', data=stream)
        rows = [json.loads(line) for line in out.splitlines()]
        assert (status, err, len(rows)) == (0, '', len(chosen))
        for row, vector in zip(rows, chosen):
            assert row['message'] == vector['message'] and row['version'] is None
            assert {name: row[name] for name in vector['si']} == {
                name: pytest.approx(value) for name, value in vector['si'].items()}


def test_csv_has_one_column_per_field():
    """Vectors have one column per axis."""
    out, _, _ = run('decode', '--format', 'csv', '-', data=build_answer(STATE, 7))
    row, = csv.DictReader(out.splitlines())
    assert (row['message'], row['message_id'], row['offset']) == ('state', '7', '0')
    assert float(row['position_ned_down']) == -3.0 and float(row['attitude_heading']) == 1.5
    assert row['zone'] == '' and float(row['angular_rate_y']) == 0.0625


def test_csv_has_empty_cells_for_unknown_values():
    """There is no position without a zone. NaN is null in JSON."""
    numbers = Gps(376038.0, 404547.27, 5790639.68, 204.0, (5.6, 43.6, 0.0), 104.0, 30.9, 31.3, 14,
                  True)
    stream = build_answer(numbers) + build_answer(dataclasses.replace(numbers, zone=0))
    stream += build_answer(dataclasses.replace(STATE, position_ned=(math.nan, math.inf, 1.0)))
    out, _, _ = run('decode', '--format', 'csv', '--payload-order', 'little', '-', data=stream)
    known, unknown, state = csv.DictReader(out.splitlines())
    for name in ('easting', 'northing', 'altitude', 'velocity_ned_north', 'speed', 'heading_deg'):
        assert float(known[name]) and not unknown[name]
    assert unknown['zone'] == '0' and float(unknown['gps_time_s'])
    assert (state['position_ned_north'], state['position_ned_east']) == ('', '')
    out, _, _ = run('decode', '--format', 'jsonl', '--payload-order', 'little', '-', data=stream)
    *_, state = [json.loads(line, parse_constant=pytest.fail) for line in out.splitlines()]
    assert state['position_ned'] == [None, None, 1.0]


def test_ambiguous_byte_order():
    """The message names the option to set."""
    data = 3 * build_answer(NOTHING)
    out, err, status = run('decode', '--format', 'jsonl', '-', data=data)
    assert (out, status) == ('', 1) and '3 answers are not decoded' in err
    out, err, status = run('decode', '--format', 'jsonl', '--payload-order', 'big', '-', data=data)
    assert (len(out.splitlines()), err, status) == (3, '', 0)
    # A later answer decides the byte order of these, too.
    out, _, _ = run('decode', '--format', 'jsonl', '-', data=data + build_answer(STATE))
    assert [json.loads(line)['offset'] for line in out.splitlines()] == [0, 56, 112, 168]


def test_an_emulated_flight(tmp_path):
    """The file has the answers to all requests, with the ground truth."""
    file, truth = tmp_path / 'flight.bin', tmp_path / 'truth.jsonl'
    _, err, status = run('emulate', '--output', str(file), '--duration', '20', '--truth',
                         str(truth), '--motion', 'steady-turn', '--payload-order', 'big',
                         '--sensors-len', '0x2E', '--first-fix', '5')
    assert status == 0, err
    out, _, status = run('decode', str(file))
    rows = {line[:22].strip(): line[22:].strip() for line in out.splitlines()}
    # Half an answer is on the line yet at the end.
    assert status == 0 and int(rows['sensors'].replace(',', '')) in (1000, 1001)
    assert rows['payload byte order'] == 'big' and rows['skipped bytes'] == '0'
    out, _, _ = run('decode', '--format', 'jsonl', str(file))
    found = [json.loads(line) for line in out.splitlines()]
    true = [json.loads(line) for line in truth.read_text().splitlines()]
    assert len(found) == len(true)
    for row, line in zip(found, true):
        if row['message'] == 'state':
            assert row['velocity_ned'] == pytest.approx(line['velocity_ned'], abs=1e-5)
    zones = [row['zone'] for row in found if row['message'] == 'gps']
    assert set(zones[:49]) == {0} and set(zones[51:]) == {32}
    moved = [row['position_ned'] for row in found if row['message'] == 'state']
    assert moved[0] == [0.0] * 3 and math.hypot(*moved[-1]) > 500


@pytest.mark.parametrize('words, sentence', [
    (['--crc', 'byte'], '--crc is an option of a bahrs, not of a titan_m'),
    (['--start', '47'], "the start is '47': it must be a latitude and a longitude"),
    (['--start', '91,0'], "the latitude of the start is '91': it must be a number from -80 to 80"),
    (['--late-answers', '2'], "a share is '2': it must be a number from 0 to 1"),
])
def test_emulate_errors(words, sentence):
    """The error is one sentence."""
    _, err, status = run('emulate', *words)
    assert status != 0 and sentence in err


def test_bytes_without_times_are_not_converted(tmp_path):
    """Answers have no times; the message has the remedy."""
    file = tmp_path / 'flight.bin'
    file.write_bytes(build_answer(STATE))
    _, err, status = run('convert', str(file), str(tmp_path / 'out'))
    assert status == 1 and 'record the topic raw' in err and not (tmp_path / 'out').exists()
