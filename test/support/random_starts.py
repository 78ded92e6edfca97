# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Starts of the node that a signal ends at a random moment."""

from collections.abc import Iterator
import contextlib
import random
import signal
import time
from typing import NamedTuple

from bahrs_driver.virtual_serial.pty_port import PtyPort
from support.devices import Device
from support.processes import driver
from support.set_clock import SettableClock

LONGEST_RUN = 3.0       # s from the start to the signal
HOUR = 3600.0           # s
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Exit(NamedTuple):
    """How a start ended."""

    delay: float            # s from the start to the signal
    kind: signal.Signals
    clock_set_back: bool
    status: int
    duration: float         # s from the signal to the end of the process
    text: str


def random_starts(count: int, clock: SettableClock, seed: int,
                  handled: bool = True) -> Iterator[Exit]:
    """
    Start the node and end it so many times; every third time the host clock is set back before.

    The signal comes after the node has installed its handlers, unless handled is False; the port
    is missing, silent, or sends data.
    """
    generator = random.Random(seed)
    for number in range(count):
        clock.set_back(0.0)
        with contextlib.ExitStack() as stack:
            port = stack.enter_context(PtyPort())
            path = port.path if number % 4 else '/dev/missing'
            if number % 4 > 1:
                stack.enter_context(Device(port))
            stack.enter_context(clock.used())
            node = stack.enter_context(driver(path))
            begin = time.monotonic()
            while handled and not handles_signals(node.pid):
                time.sleep(0.001)
            delay, kind = generator.uniform(0.0, LONGEST_RUN), generator.choice(SIGNALS)
            set_back = number % 3 == 0
            time.sleep(delay * (0.5 if set_back else 1.0))
            if set_back:
                clock.set_back(HOUR)
                time.sleep(delay / 2)
            delay = time.monotonic() - begin
            sent = time.monotonic()
            status = node.end(kind)
            yield Exit(delay, kind, set_back, status, time.monotonic() - sent, node.text)


def handles_signals(pid: int) -> bool:
    """Return whether a process handles SIGTERM."""
    with open(f'/proc/{pid}/status') as file:
        caught = next(int(line.split()[1], 16) for line in file if line.startswith('SigCgt'))
    return bool(caught >> (signal.SIGTERM - 1) & 1)
