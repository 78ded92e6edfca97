# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs monitor` where its output is no terminal, as a process beside the node."""

import json
import subprocess

from bahrs_driver.convert.bahrs import TOPICS
from bahrs_driver.emulator.pty_port import PtyPort
from devices import Device
from processes import command, driver, running, wait_for


def watched(*words):
    """Return exit status and output of a monitor that listens for a while."""
    done = subprocess.run(command('bahrs', 'monitor', '--duration', '2', *words),
                          capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout, done.stderr


def watched_until(words, *options):
    """Return what a monitor prints as soon as it has heard enough to say all of some words."""
    said = ['']

    def heard():
        status, said[0], complaints = watched(*options)
        assert complaints == ''
        return status == 0 and all(word in said[0] for word in words)

    assert wait_for(heard, 120), said[0]
    return said[0]


def test_every_topic_and_task_is_shown():
    """With what came last, for people and for scripts."""
    with PtyPort() as cable, driver(cable.path), Device(cable):
        # How soon a topic is found is up to the machine, and two seconds are few.
        words = ('device time', ' m/s', f'{cable.path} is open', *TOPICS)
        text = watched_until(words)
        record = watched_until(words, '--json')
    rows = {line.split()[0]: line for line in text.splitlines() if line.strip()}
    assert set(TOPICS) <= set(rows)
    assert ' m/s' in rows['velocity'] and 'device time' in rows['time_reference']
    assert f'{cable.path} is open' in text
    assert '\x1b' not in text
    found = json.loads(record)
    assert set(found['topics']) >= set(TOPICS)
    assert found['topics']['imu/data_raw']['count'] > 0
    assert found['diagnostics']['Link']['message'] == f'{cable.path} is open'


def test_without_a_driver():
    """It says so, and the exit status is not 0."""
    with running('bahrs', 'monitor', '--duration', '1', '--namespace', 'nobody') as monitor:
        assert monitor.wait(60) == 1
        assert 'is driver_node running' in monitor.text


def test_a_namespace_that_is_none():
    """One sentence."""
    with running('bahrs', 'monitor', '--namespace', 'no body') as monitor:
        assert monitor.wait(60) == 1
        assert monitor.text == ("bahrs monitor: 'no body' is no namespace: it must be a name such "
                                'as /left\n')


def test_a_domain_that_is_none(monkeypatch):
    """One sentence, where ROS would say it with a traceback."""
    monkeypatch.setenv('ROS_DOMAIN_ID', '900')
    with running('bahrs', 'monitor', '--duration', '1') as monitor:
        assert monitor.wait(60) == 1
        assert monitor.text == ("bahrs monitor: ROS_DOMAIN_ID is '900': it must be a number from "
                                '0 to 101\n')
