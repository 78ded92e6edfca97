# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The driver started in this process, and ended at once: what it returns and prints."""

import functools
import sys
from typing import Any, NamedTuple

from bahrs_driver.node import process as node_process
from bahrs_driver.process.shutdown_event import ShutdownEvent
from support.domain import claim_domain


class Start(NamedTuple):
    """An exit status, and the lines that were printed."""

    status: int
    lines: list[str]

    @property
    def text(self) -> str:
        """All lines."""
        return '\n'.join(self.lines)


class _EndAtOnce(ShutdownEvent):
    """An event that is set as soon as the driver waits for it."""

    def __init__(self) -> None:
        super().__init__()
        self.set()

    def is_set(self) -> bool:
        return False


@functools.cache
def _other_domain() -> str:
    """Return a domain in which no other test of this process listens."""
    return str(claim_domain())


def start(monkeypatch: Any, capfd: Any, *words: str, port: str = '/nowhere') -> Start:
    """Start the driver with arguments of ROS, and let it end."""
    # A node that could not start remains until the garbage collector finds it.
    monkeypatch.setenv('ROS_DOMAIN_ID', _other_domain())
    arguments = ['driver_node', '--ros-args', '-p', f'port:={port}', *words]
    monkeypatch.setattr(sys, 'argv', arguments)
    capfd.readouterr()
    # The time limit would end this process, too.
    monkeypatch.setattr(node_process, 'exit_after', lambda seconds: None)
    status = node_process.run(_EndAtOnce())
    printed = capfd.readouterr()
    # There is no such port, which is not what is asked here.
    lines = [line for line in (printed.out + printed.err).splitlines()
             if f'{port} does not exist' not in line]
    return Start(status, lines)
