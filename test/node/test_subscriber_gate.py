# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The gate holds a thread back until all publishers have a subscriber, but not for ever."""

import threading

from bahrs_driver.node.subscriber_gate import SubscriberGate
from support.waiting import PATIENCE


class FakePublisher:
    """A publisher with a number of subscribers that tests set."""

    def __init__(self, count):
        """Begin with a number of subscribers."""
        self.count = count

    def get_subscription_count(self):
        """Return the number of subscribers."""
        return self.count


def test_the_last_subscriber_opens_it():
    """The matched event of a publisher ends the wait, and nothing is missing then."""
    gate, publishers, logs = SubscriberGate(PATIENCE), {}, []
    publishers.update(first=FakePublisher(1), second=FakePublisher(0))
    waiting = threading.Event()
    thread = threading.Thread(target=gate.wait, args=(
        publishers, lambda text: waiting.set(), logs.append))
    thread.start()
    assert waiting.wait(PATIENCE)
    callbacks = gate.callbacks()
    callbacks.matched(None)
    assert thread.is_alive()
    publishers['second'].count = 1
    callbacks.matched(None)
    thread.join(PATIENCE / 2)
    assert not thread.is_alive() and not logs


def test_what_is_missing_is_named():
    """After the limit."""
    logs = []
    SubscriberGate(0.01).wait(
        {'imu/data': FakePublisher(1), 'imu/mag': FakePublisher(0), 'fix': FakePublisher(0)},
        str, logs.append)
    assert logs == ['no subscriber within 0.01 s of imu/mag, fix: the port is opened without them']


def test_no_wait():
    """Without a limit nothing waits, and publishers need no event callbacks."""
    logs = []
    gate = SubscriberGate(0.0)
    gate.wait({'imu/mag': FakePublisher(0)}, logs.append, logs.append)
    assert gate.callbacks() is None and not logs


def test_shutdown_ends_the_wait():
    """Without a warning."""
    logs = []
    gate = SubscriberGate(PATIENCE)
    gate.open()
    gate.wait({'imu/mag': FakePublisher(0)}, logs.append, logs.append)
    assert not logs
