# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A plain device for tests of the node, and what the node says of it."""

from collections.abc import Callable, Iterator
import threading
import time
from typing import Any, TypeVar

from bahrs_driver.convert.bahrs.converter import TOPICS
from bahrs_driver.protocol.bahrs.frames import BahrsCodec
from bahrs_driver.protocol.bahrs.messages import (
    Accuracy, ANGLE, BahrsMessage, FORCE, HEIGHT, Inertial, InertialTime, Navigation,
    NavigationTime, SyncPulseTime, VELOCITY,
)
from bahrs_driver.protocol.integrity import Integrity
from bahrs_driver.virtual_serial.pty_port import PtyPort
from diagnostic_msgs.msg import DiagnosticArray
from support.processes import Listener
from support.waiting import PATIENCE, wait_for

DIAGNOSTICS = {'/diagnostics': DiagnosticArray}
SAFE = (Integrity.SAFE,) * 6
Words = tuple[Integrity, ...]
Started = TypeVar('Started', bound='StoppableThread')
# For the node where every message counts: a queue that no pause of a listener lets run over.
DEEP = {f'qos_overrides./{topic}.publisher.depth': 5000 for topic in (*TOPICS, 'raw')}


class StoppableThread(threading.Thread):
    """A thread that runs as long as its context; run() ends once _ended is set."""

    def __init__(self) -> None:
        """Make it, to be started."""
        super().__init__(daemon=True)
        self._ended = threading.Event()

    def __enter__(self: Started) -> Started:
        """Start."""
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop."""
        self._ended.set()
        self.join()


class Device(StoppableThread):
    """Sends an endless stream of frames, 200 inertial ones a second, until it is stopped."""

    def __init__(self, port: PtyPort, version: int = 3,
                 health: Callable[[int], tuple[Words, Words]] | None = None,
                 change: Callable[[bytes, int], bytes] | None = None) -> None:
        """
        Send on a port.

        health gives the health of inertial and navigation message number so-and-so; change may
        alter the bytes of each frame, or return none.
        """
        super().__init__()
        self.inertial: list[Inertial] = []
        self.navigation: list[Navigation] = []
        self._port, self._version = port, version
        self._health = health or (lambda index: (SAFE, SAFE[:5]))
        self._change = change or (lambda data, index: data)

    def run(self) -> None:
        """Send until stopped, at the rates and in the order of the real device."""
        # What is sent to a port that nobody has open would wait there, and come late.
        while not self._port.is_open and not self._ended.wait(0.005):
            pass
        codec, index, start = BahrsCodec(), 0, time.monotonic()
        while not self._ended.wait(max(0.0, start + 0.005 * index - time.monotonic())):
            for message in self._messages(index):
                self._port.write(self._change(codec.encode(message, self._version), index))
            index += 1

    def _messages(self, index: int) -> Iterator[BahrsMessage]:
        inertial, navigation = self._health(index)
        # Force along x, height, velocity and heading tell the number of their message.
        force = (FORCE * index, 0.0, -9.8)
        self.inertial.append(Inertial(index % 256, force, (0.0, 0.0, 0.0), inertial))
        yield self.inertial[-1]
        if index % 20 == 0:
            yield InertialTime(index // 20 % 256, (index + 1) % 256, 5000 * index)
        if index % 2 == 0:
            turn = index // 2
            self.navigation.append(Navigation(
                turn % 256, HEIGHT * turn, VELOCITY * turn, 0.1, 0.2, ANGLE * turn, navigation))
            yield self.navigation[-1]
        if index % 20 == 0:
            yield SyncPulseTime(index // 20 % 256, 5000 * index)
            yield Accuracy(index // 20 % 256, 0.01, 0.02, 0.03, 5000 * index)
            yield NavigationTime(index // 20 % 256, (index // 2 + 1) % 256, 5000 * index)


def known(ear: Listener) -> None:
    """
    Wait until the node has found all that an ear has made so far, clients, too.

    A node hears of others in the order in which they were made, and an answer to a client that it
    has not heard of is lost. What is made last here hears the diagnostics, which come of
    themselves.
    """
    heard: list[DiagnosticArray] = []
    ear.node.create_subscription(DiagnosticArray, '/diagnostics', heard.append, 10)
    assert wait_for(lambda: heard)


def client_of(ear: Listener, kind: type, name: str) -> Any:
    """Return the client of an ear for a service, once the node will find it with its answers."""
    if name not in ear.clients:
        ear.clients[name] = ear.node.create_client(kind, name)
        assert ear.clients[name].wait_for_service(PATIENCE)
        known(ear)
    return ear.clients[name]


def call(ear: Listener, kind: type, name: str, request: object) -> Any:
    """Call a service and return its response."""
    future = client_of(ear, kind, name).call_async(request)
    assert wait_for(future.done)
    return future.result()


def status(ear: Listener, task: str) -> Any:
    """Return the latest status of a task, or None."""
    return next((item for array in reversed(ear.messages['/diagnostics']) for item in array.status
                 if item.name == f'bahrs_driver: {task}'), None)


def says(ear: Listener, task: str, level: bytes, words: str) -> bool:
    """Wait until a task has a level and says the words."""
    def so() -> bool:
        latest = status(ear, task)
        return bool(latest and latest.level == level and words in latest.message)
    return wait_for(so)
