# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Time from the start of a process to its first message in a subscriber of another process.

The device sends before the node starts. The floor imports rclpy, makes a node and a publisher, and
publishes at once. Both take turns; each figure is the least of the rounds, because in many of
them, of both alike, the middleware discovers the publisher two or three seconds late.
"""

from collections.abc import Iterator
import contextlib
import time

from bahrs_driver.virtual_serial.pty_port import PtyPort
from harness.row import at_most, Row
from node_cpu import script
from support.devices import Device
from support.processes import driver, Process
from support.waiting import wait_for

ROUNDS = 9
SILENCE = 1.0           # s, longer than what the subscriber takes for a pause


def measure() -> Iterator[Row]:
    """Measure in turns."""
    with script('first_message_subscriber') as subscriber:
        assert wait_for(lambda: 'ready' in subscriber.text)
        rounds = [(_bare(subscriber), _node(subscriber)) for _ in range(ROUNDS)]
    bare, node = map(min, zip(*rounds))
    yield Row('start of the process to the first message', node, 's', at_most('ratio', 1.8),
              at_most('ratio', 1.56), bare, 'rclpy, a node and a publisher')


def _bare(subscriber: Process) -> float:
    return _first(subscriber, script('bare_start'))


def _node(subscriber: Process) -> float:
    with PtyPort() as port, Device(port):
        return _first(subscriber, driver(port.path))


def _first(subscriber: Process, starting: contextlib.AbstractContextManager[Process]) -> float:
    """Return the time from the start of a process to the first message, in s."""
    time.sleep(SILENCE)
    seen, begin = len(subscriber.lines), time.monotonic()
    with starting:
        assert wait_for(lambda: len(subscriber.lines) > seen)
    return float(subscriber.lines[seen]) - begin
