# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run the commands as processes, and listen to their topics."""

from collections import defaultdict
from collections.abc import Iterator
import contextlib
from pathlib import Path
import signal
import subprocess
import sys
import threading
from typing import Any

from bahrs_driver.convert.bahrs.converter import LATCHED
import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from support.ros_messages import message_types
from support.waiting import PATIENCE, wait_for

BIN = Path(sys.executable).parent
MODULES = {'bahrs': 'bahrs_driver.cli.main', 'driver_node': 'bahrs_driver.node.main'}


def command(name: str, *words: str) -> list[str]:
    """Return how to run a command of ours: as it is installed beside this Python, or without."""
    script = BIN / name
    if script.exists():
        return [str(script), *words]
    code = f'import sys; from {MODULES[name]} import main; sys.exit(main())'
    return [sys.executable, '-c', code, *words]


class Process:
    """A child process whose output can be waited for and read."""

    def __init__(self, command: list[str]) -> None:
        """Start it."""
        self._child = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, bufsize=1)
        assert self._child.stdin and self._child.stdout
        self._input, self._output = self._child.stdin, self._child.stdout
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        self.lines.extend(iter(self._output.readline, ''))

    @property
    def text(self) -> str:
        """All that it has printed so far."""
        return ''.join(self.lines)

    @property
    def pid(self) -> int:
        """Return the number of the process."""
        return self._child.pid

    def send_line(self, line: str) -> None:
        """Write a line to its standard input."""
        self._input.write(f'{line}\n')
        self._input.flush()

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._child.poll() is None

    def end(self, number: int = signal.SIGINT) -> int:
        """Send a signal if it still runs, wait, and return its exit status."""
        if self.alive:
            self._child.send_signal(number)
        try:
            return self.wait()
        except BaseException:           # the time limit, or Ctrl-C: an orphan disturbs later runs
            self._child.kill()
            self.wait()
            raise

    def wait(self, timeout: float = PATIENCE) -> int:
        """Wait until it ends by itself and return its exit status."""
        status = self._child.wait(timeout)
        self._reader.join(timeout)
        self._output.close()
        self._input.close()
        return status


@contextlib.contextmanager
def running(name: str, *words: str) -> Iterator[Process]:
    """Run a command of ours, and end it at the end."""
    process = Process(command(name, *words))
    try:
        yield process
    finally:
        if process.alive:
            process.end()


def driver(port: str, **parameters: Any) -> contextlib.AbstractContextManager[Process]:
    """Run the node on a port; two underscores in a name stand for a dot."""
    words = [word for name, value in {'port': port, **parameters}.items()
             for word in ('-p', f"{name.replace('__', '.')}:={value}")]
    return running('driver_node', '--ros-args', *words)


class Listener:
    """Subscribes to topics, in its own thread, and keeps all messages by topic."""

    def __init__(self, topics: dict[str, type]) -> None:
        """Subscribe."""
        self.messages: dict[str, list[Any]] = defaultdict(list)
        self.clients: dict[str, Any] = {}       # of services, by name
        self._context = Context()
        rclpy.init(context=self._context)
        self.node = rclpy.create_node('ear', context=self._context)
        for topic, kind in topics.items():
            profile = QoSProfile(depth=2000)
            if topic in LATCHED:
                profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
            self.node.create_subscription(message_types({topic: kind})[topic], topic,
                                          self.messages[topic].append, profile)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with contextlib.suppress(ExternalShutdownException):
            while not self._ended.is_set():
                self._executor.spin_once(0.1)

    def wait(self, topic: str, count: int = 1, timeout: float = PATIENCE) -> list[Any]:
        """Wait for count messages on a topic; return all of them."""
        assert wait_for(lambda: len(self.messages[topic]) >= count, timeout), (
            f'{len(self.messages[topic])} of {count} messages on {topic} in {timeout} s')
        return self.messages[topic]

    def close(self) -> None:
        """Stop listening."""
        self._ended.set()
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)


@contextlib.contextmanager
def listening(topics: dict[str, type]) -> Iterator[Listener]:
    """Listen to topics for the length of a block."""
    ear = Listener(topics)
    try:
        yield ear
    finally:
        ear.close()
