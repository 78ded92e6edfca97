# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A device in one module works in every program, and no other file changes."""

import contextlib
import csv
import json
from pathlib import Path
import re
import subprocess
import sys

from bahrs_driver.bag.read_metadata import ReadMetadata
from bahrs_driver.convert import raw
from bahrs_driver.ros_layout.layouts import serialize
from bahrs_driver.units import NS_PER_S
from diagnostic_msgs.msg import DiagnosticStatus
import pytest
from rosbags.rosbag2 import StoragePlugin
from std_msgs.msg import Float64, UInt8MultiArray
from support.bags import write_bag
from support.devices import DIAGNOSTICS, says, status
from support.processes import listening, Process, wait_for

GUIDE = Path(__file__).parents[2] / 'docs' / 'adding-a-device.md'
SCRIPT = Path(__file__).with_name('rangefinder.py')
FRAME_SIZE, PERIOD_NS = 8, NS_PER_S // 20
SENSOR = ('--sensor', 'rangefinder')


def run(*words):
    """Run a verb with the device in the registry; return its output."""
    return subprocess.run([sys.executable, SCRIPT, 'bahrs', *words], capture_output=True,
                          text=True, check=True, timeout=120).stdout


@contextlib.contextmanager
def running(*words):
    """Run a command with the device in the registry for the length of a block."""
    process = Process([sys.executable, str(SCRIPT), *words])
    try:
        yield process
    finally:
        process.end()


@pytest.fixture(scope='module')
def recording(tmp_path_factory):
    """Return a file of a minute of an emulated rangefinder, in flight."""
    path = tmp_path_factory.mktemp('emulated') / 'ranges.bin'
    run('emulate', *SENSOR, '--output', str(path), '--duration', '60')
    return path


def raw_messages(recording):
    """Yield a raw message a frame, as the node publishes it, with its log time."""
    data = recording.read_bytes()
    for index in range(len(data) // FRAME_SIZE):
        at = 1_700_000_000 * NS_PER_S + index * PERIOD_NS
        label = ReadMetadata('rangefinder', 1, 86805, at, at).to_label()
        frame = data[index * FRAME_SIZE:(index + 1) * FRAME_SIZE]
        yield at, serialize(raw.message(frame, label))


@pytest.fixture
def heights(recording):
    """Return the ranges that `bahrs decode` prints."""
    lines = run('decode', *SENSOR, '--format', 'jsonl', str(recording)).splitlines()
    messages = [json.loads(line) for line in lines]
    assert [message['sequence'] for message in messages] == [
        index % 256 for index in range(len(messages))]
    return [message['range'] for message in messages]


def test_emulate_and_decode(heights):
    """Every range is emulated and decoded."""
    assert len(heights) in (1200, 1201)
    assert len(set(heights)) > 100


def test_decode_to_csv(recording, heights):
    """The columns are the fields of the message."""
    rows = list(csv.DictReader(run('decode', *SENSOR, '--format', 'csv',
                                   str(recording)).splitlines()))
    assert list(rows[0]) == ['message', 'offset', 'sequence', 'range']
    assert [float(row['range']) for row in rows] == heights


def test_convert(recording, heights, tmp_path):
    """A bag of raw bytes becomes the topics of the device, and its diagnostics."""
    bag = write_bag(tmp_path / 'bag', StoragePlugin.MCAP, items=list(raw_messages(recording)))
    run('convert', str(bag), str(tmp_path / 'csv'), '--as', 'csv')
    with (tmp_path / 'csv' / 'range.csv').open() as file:
        assert [float(row['data']) for row in csv.DictReader(file)] == heights
    assert 'rangefinder' in (tmp_path / 'csv' / 'diagnostics.csv').read_text()


def test_node(tmp_path):
    """The node publishes what an emulated device on a port sends, and finds it healthy."""
    port = str(tmp_path / 'port')
    topics = {'range': Float64, 'raw': UInt8MultiArray, **DIAGNOSTICS}
    with listening(topics) as ear, running('bahrs', 'emulate', *SENSOR, '--link', port):
        assert wait_for(lambda: Path(port).exists())
        with running('driver_node', '--ros-args', '-p', 'sensor:=rangefinder', '-p',
                     f'port:={port}', '-p', 'publish.raw:=true'):
            ear.wait('range', 20)
            assert says(ear, 'Framing', DiagnosticStatus.OK, 'All frames intact')
            assert wait_for(lambda: status(ear, 'Rates').level == DiagnosticStatus.OK)
            assert ear.wait('raw')[0].layout.dim[0].label.startswith('sensor=rangefinder ')
            shown = json.loads(run('monitor', '--duration', '5', '--json'))
            assert shown['topics']['range']['latest'].startswith('std_msgs.msg.Float64(data=')


def test_the_guide_quotes_the_module():
    """The code of docs/adding-a-device.md is that of the module."""
    text, module = GUIDE.read_text(), SCRIPT.read_text()
    blocks = re.findall(r'^```py\n(.*?)^```$', text, re.MULTILINE | re.DOTALL)
    assert len(blocks) == 7
    assert [block for block in blocks if block not in module] == []
