# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Tests of `bahrs monitor` without a terminal, as a process beside the node."""

import contextlib
import json
import subprocess

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.virtual_serial.pty_port import PtyPort
import pytest
from support.devices import Device
from support.in_process import run_bahrs
from support.processes import command, driver, PATIENCE, running, wait_for


def watched_until(enough, *options):
    """
    Return exit status, output and complaints of the first monitor that has heard enough.

    How soon a topic is found is up to the machine: each monitor listens twice as long as the
    one before.
    """
    for seconds in (2, 4, 8, 16, 32, 64):
        done = subprocess.run(
            command('bahrs', 'monitor', '--duration', str(seconds), *options),
            capture_output=True, text=True, timeout=seconds + PATIENCE, check=False)
        found = done.returncode, done.stdout, done.stderr
        if enough(*found):
            return found
    raise AssertionError(found)


def shown_by(words, *options):
    """Return the output of a monitor when it contains all of some words."""
    def enough(status, text, complaints):
        assert complaints == ''
        return status == 0 and all(word in text for word in words)

    return watched_until(enough, *options)[1]


def test_every_topic_and_task_is_shown():
    """The latest values are in the table and in the JSON object."""
    with PtyPort() as cable, driver(cable.path), Device(cable):
        words = ('device time', ' m/s', f'{cable.path} is open', *TOPICS)
        text = shown_by(words)
        record = shown_by(words, '--json')
    rows = {line.split()[0]: line for line in text.splitlines() if line.strip()}
    assert set(TOPICS) <= set(rows)
    assert ' m/s' in rows['velocity'] and 'device time' in rows['time_reference']
    assert f'{cable.path} is open' in text
    assert '\x1b' not in text
    found = json.loads(record)
    assert set(found['topics']) >= set(TOPICS)
    assert found['topics']['imu/data_raw']['count'] > 0
    assert found['diagnostics']['Link']['message'] == f'{cable.path} is open'


def test_best_effort_publishers():
    """A reliable subscription would receive nothing."""
    topics = ('/imu/data', '/diagnostics')
    overrides = {f'qos_overrides.{topic}.publisher.reliability': 'best_effort'
                 for topic in topics}
    with PtyPort() as cable, driver(cable.path, **overrides), Device(cable):
        shown_by((f'{cable.path} is open', 'imu/data '))


def test_without_a_driver():
    """The exit status is not 0, and the reason is printed."""
    with running('bahrs', 'monitor', '--duration', '1', '--namespace', 'nobody') as monitor:
        assert monitor.wait(60) == 1
        assert 'is driver_node running' in monitor.text


@contextlib.contextmanager
def named_driver(cable, *words):
    """Run a driver with another name, and wait until it has opened the port."""
    with running('driver_node', '--ros-args', '-p', f'port:={cable.path}', *words) as node:
        assert wait_for(lambda: cable.is_open), node.text
        yield


@pytest.mark.parametrize('words, options, name', [
    (['-r', '__ns:=/left'], [], '/left/bahrs_driver'),
    (['-r', '__ns:=/left'], ['--namespace', '/left'], '/left/bahrs_driver'),
    (['-r', '__node:=front'], [], '/front'),
    (['-r', '__node:=front', '-r', '__ns:=/uav/left'], ['--node', 'front'], '/uav/left/front'),
    (['-p', 'diagnostics.qualified_name:=true'], [], '/bahrs_driver'),
    (['-r', '__ns:=/left'], ['--ros-args', '-r', '__ns:=/left'], '/left/bahrs_driver'),
])
def test_the_only_driver_is_found(words, options, name):
    """It is found by any name, with its topics and its health."""
    def complete(status, text, complaints):
        found = json.loads(text)
        return found['node'] == name and found['topics']['imu/data']['count'] \
            and 'is open' in found['diagnostics'].get('Link', {}).get('message', '')

    with PtyPort() as cable, Device(cable), named_driver(cable, *words):
        watched_until(complete, '--json', *options)


@pytest.mark.slow
def test_several_drivers():
    """The monitor lists them unless one is named."""
    with PtyPort() as left, PtyPort() as right, Device(left), \
            named_driver(left, '-r', '__ns:=/left'), named_driver(right, '-r', '__ns:=/right'):
        def message(side, text):
            found = json.loads(text)
            assert found['node'] == f'/{side}/bahrs_driver'
            return found['diagnostics'].get('Link', {}).get('message', '')

        watched_until(lambda _, text, __: message('left', text) == f'{left.path} is open',
                      '--json', '--node', '/left/bahrs_driver')
        watched_until(
            lambda _, text, __: f'{right.path} is open but silent' in message('right', text),
            '--json', '--node', '/right/bahrs_driver')
        for options in ([], ['--node', 'bahrs_driver'], ['--json']):
            watched_until(lambda *found: found == (1, '', (
                'bahrs monitor: /left/bahrs_driver and /right/bahrs_driver run: choose one with '
                '--node /left/bahrs_driver\n')), *options)


@pytest.mark.parametrize('options, sentence', [
    (['--node', 'no body'], "'no body' is not the name of a node"),
    (['--node', '/'], "'' is not the name of a node"),
    (['--node', '/no body/front'], "'/no body' is not a namespace"),
    (['--node', '/left/front', '--namespace', '/right'],
     '--node /left/front is not in --namespace /right'),
    (['--node', '\udcff'], r"'\udcff' is not the name of a node"),
    (['--namespace', '\udcff'], r"'\udcff' is not a namespace"),
])
def test_invalid_names(options, sentence):
    """Each error is one sentence."""
    status, text, complaint = run_bahrs('monitor', *options)
    assert status == 1 and text == ''
    assert complaint.startswith(f'bahrs monitor: {sentence}') and complaint.count('\n') == 1


def test_an_invalid_namespace():
    """The error is one sentence."""
    assert run_bahrs('monitor', '--namespace', 'no body') == (
        1, '', "bahrs monitor: 'no body' is not a namespace: write a name such as /left\n")


def test_an_invalid_domain(monkeypatch):
    """The error is one sentence, without the traceback of ROS."""
    monkeypatch.setenv('ROS_DOMAIN_ID', '900')
    assert run_bahrs('monitor', '--duration', '1') == (
        1, '', "bahrs monitor: ROS_DOMAIN_ID is '900': it must be a number from 0 to 101\n")
