# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Test which subscribers receive which notices on `integrity`, with real processes."""

import os
import signal
import sys

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.protocol.integrity import Integrity
import pytest
from support import integrity_subscriber
from support.devices import Device, SAFE
from support.processes import driver, listening, Process, wait_for

SUBSCRIBER = [sys.executable, integrity_subscriber.__file__]
SIGNALS = 5
CHANGES = 8


class Numbered:
    """The health of all messages: a number in the states of the navigation signals."""

    def __init__(self):
        self.number = 0

    def __call__(self, index):
        """Return the health of inertial and navigation messages."""
        return SAFE, tuple(
            Integrity.INTEGRITY_RISK if self.number >> bit & 1 else Integrity.SAFE
            for bit in range(SIGNALS))


def letters(number):
    """Return how a subscriber prints the state with a number."""
    return ''.join('i' if number >> bit & 1 else 's' for bit in range(SIGNALS))


def heard(ear):
    """Return the states that this process has received."""
    return [''.join(status.message[0] for status in notice.status[-SIGNALS:])
            for notice in ear.messages['integrity']]


def join_late():
    """Return the first state that a late subscriber receives, and end it."""
    late = Process([*SUBSCRIBER, '--once'])
    late.wait()
    return late.text.split()[0]


@pytest.fixture
def changing(cable):
    """Yield a listener, and a function that changes the integrity and waits for its notice."""
    health = Numbered()

    def change():
        health.number += 1
        assert wait_for(lambda: heard(ear)[-1:] == [letters(health.number)])

    with listening(TOPICS) as ear, driver(cable.path), Device(cable, health=health):
        assert wait_for(lambda: heard(ear)[-1:] == [letters(0)])
        yield ear, change


def test_the_first_message_of_a_late_joiner_is_the_present_state(changing):
    """As `ros2 topic echo --once` shows it, after many changes."""
    ear, change = changing
    for turn in range(1, 4):
        for _ in range(5):
            change()
        assert join_late() == letters(5 * turn)
    assert ear.node.count_publishers('integrity') == 1


def test_a_subscriber_that_is_stopped_loses_no_change(changing):
    """It neither delays other subscribers, nor leaves an obsolete state to late ones."""
    ear, change = changing
    stopped = Process(SUBSCRIBER)
    try:
        assert wait_for(lambda: letters(0) in stopped.text)
        os.kill(stopped.pid, signal.SIGSTOP)
        # What fills its socket makes the middleware need what the publisher has kept.
        for _ in range(CHANGES):
            ear.wait('imu/data_raw', len(ear.messages['imu/data_raw']) + 100)
            change()
        assert letters(1) not in stopped.text
        os.kill(stopped.pid, signal.SIGCONT)
        expected = {letters(number) for number in range(CHANGES + 1)}
        assert wait_for(lambda: set(stopped.text.split()[::2]) >= expected), stopped.text
        assert wait_for(lambda: ear.node.count_publishers('integrity') == 1)
        assert wait_for(lambda: stopped.text.split()[-2] == letters(CHANGES))
    finally:
        os.kill(stopped.pid, signal.SIGCONT)
        stopped.end()
    assert join_late() == letters(CHANGES)


def test_stamps_never_decrease_over_silence_and_lost_links(cable):
    """From the first notice on, for any first message of the stream."""
    with listening(TOPICS) as ear, driver(cable.path, diagnostics__silence_timeout=0.3):
        for start in range(1, 4):
            with Device(cable, health=Numbered()):
                assert wait_for(lambda: heard(ear)[-1:] == [letters(0)])
            assert wait_for(lambda: heard(ear)[-1:] == ['n' * SIGNALS])
            assert heard(ear).count('n' * SIGNALS) >= start
    stamps = [notice.header.stamp.sec * 10**9 + notice.header.stamp.nanosec
              for notice in ear.messages['integrity']]
    assert stamps == sorted(stamps) and len(stamps) >= 6
