# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs monitor`, as a process beside the node."""

from bahrs_driver.convert.bahrs import TOPICS
from bahrs_driver.emulator.pty_port import PtyPort
from devices import Device
from processes import driver, running


def test_every_topic_and_task_is_shown():
    """With what came last; a machine that does much else is given more time."""
    with PtyPort() as cable, driver(cable.path), Device(cable):
        for duration in (4, 40):
            with running('bahrs', 'monitor', '--duration', str(duration)) as monitor:
                assert monitor.wait() == 0, monitor.text
            rows = {line.split()[0]: line for line in monitor.lines if line.strip()}
            if 'device time' in rows['time_reference']:
                break
    assert set(TOPICS) <= set(rows)
    assert ' m/s' in rows['velocity'] and 'device time' in rows['time_reference']
    assert f'{cable.path} is open' in monitor.text
    assert 'Traceback' not in monitor.text


def test_without_a_driver():
    """It says so, and the exit status is not 0."""
    with running('bahrs', 'monitor', '--duration', '1', '--namespace', 'nobody') as monitor:
        assert monitor.wait() == 1
        assert 'is driver_node running' in monitor.text
