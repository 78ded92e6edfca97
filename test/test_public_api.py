# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The public interface is complete, its examples work, and it needs neither ROS nor numpy."""

import doctest
import os
from pathlib import Path
import subprocess
import sys

import bahrs_driver
from bahrs_driver import decode, DEVICES, Instant
from bahrs_driver.emulator.bahrs.nvm_image import example_image
from bahrs_driver.protocol.titan_m.frames import build_answer
from bahrs_driver.protocol.titan_m.messages import Gps, Sensors, State
import pytest
from support.emulated import make_emulation
from support.titan_m_frames import GPS, SENSORS, STATE

ROOT = Path(__file__).resolve().parents[1]
HEAVY = ('rclpy', 'sensor_msgs', 'numpy', 'serial', 'pyproj')
OF_TABLES = {'read', 'Table', 'Tables'}         # need numpy
LIMIT = 100         # modules of this package that all public names need


def read_stream(seconds):
    """Return the reads of an emulated device: bytes, and the instant at the end of the read."""
    emulation, reads = make_emulation(mode=0.016), []
    for index in range(1, round(seconds / 0.016)):
        now = index * 0.016
        list(emulation.advance(now))
        if data := emulation.take(now):
            elapsed = round(now * 1e9)
            reads.append((data, Instant(5 * 10 ** 9 + elapsed, 17 * 10 ** 17 + elapsed)))
    return reads


def run(code):
    """Return what a script prints."""
    return subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True,
                          env={**os.environ, 'PYTHONPATH': str(ROOT)}).stdout


def test_examples(tmp_path, monkeypatch):
    """Of the package's docstring."""
    reads = read_stream(5.0)
    (tmp_path / 'flight.bin').write_bytes(b''.join(data for data, _ in reads))
    (tmp_path / 'device.bin').write_bytes(example_image())
    monkeypatch.chdir(tmp_path)
    results = doctest.testmod(bahrs_driver, extraglobs={'reads': reads})
    assert results.attempted >= 12 and not results.failed


def test_all_names_exist():
    """Each in the module that is said to have it, and in dir()."""
    for name in bahrs_driver.__all__:
        assert getattr(bahrs_driver, name), name
    assert set(bahrs_driver.__all__) <= set(dir(bahrs_driver))
    with pytest.raises(AttributeError, match="has no attribute 'absent'"):
        bahrs_driver.absent


def test_no_name_needs_ros_or_numpy():
    """Importing the package alone imports no other module of it."""
    code = f"""
import sys, bahrs_driver
ours = lambda: [name for name in sys.modules if name.startswith('bahrs_driver.')]
print(ours())
for name in set(bahrs_driver.__all__) - {OF_TABLES}:
    getattr(bahrs_driver, name)
spec = bahrs_driver.DEVICES['bahrs']
list(bahrs_driver.decode([b'NE']))
print([name for name in {HEAVY} if name in sys.modules], len(ours()) < {LIMIT})"""
    assert run(code).splitlines() == ['[]', '[] True']


def test_decode_cuts_make_no_difference():
    """Nor does a clock, which decode() does not need."""
    data = b''.join(data for data, _ in read_stream(1.0))
    whole = list(decode([data]))
    assert list(decode(data[start:start + 7] for start in range(0, len(data), 7))) == whole
    assert {item.message.NAME for item in whole} >= {'inertial', 'navigation', 'accuracy'}
    assert [item.frame.offset for item in whole] == sorted(item.frame.offset for item in whole)


def test_decode_a_polled_device():
    """Its answers are typed messages, too; they have no device time."""
    data = b''.join(map(build_answer, (STATE, SENSORS, GPS)))
    found = list(decode([data], 'titan_m'))
    assert [type(item.message) for item in found] == [State, Sensors, Gps]
    assert found[0].message == STATE
    assert {item.device_time_us for item in found} == {None}


def test_decode_with_settings():
    """Of the device."""
    kind = DEVICES['bahrs'].settings
    data = b''.join(data for data, _ in read_stream(1.0))
    assert not list(decode([data], settings=kind(crc_order='byte')))
    assert list(decode([data], settings=kind(crc_order='word')))
