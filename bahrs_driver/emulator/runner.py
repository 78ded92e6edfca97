# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run an emulation: as fast as possible into a file, or in real time on a port."""

from collections.abc import Callable
import math
import os
import select
import time
from typing import Protocol

from bahrs_driver.emulator.host_time import HostTime
from bahrs_driver.emulator.session import Session
from bahrs_driver.errors import ControlError
from bahrs_driver.process.host_time import SystemTime
from bahrs_driver.units import NS_PER_S
from bahrs_driver.virtual_serial.pty_port import PtyPort

_LONGEST_WAIT = 0.1     # s
_WATCH = 0.0002         # s before bytes are due: stay awake, because sleeping may take too long
_READ_SIZE = 4096
_FILE_STEP = 1.0        # s of emulated time that are written to a file at once


class ByteSink(Protocol):
    """A file for the bytes of an emulation."""

    def write(self, data: bytes) -> object:
        """Append data."""


def run_to_file(session: Session, duration: float, file: ByteSink) -> None:
    """Write the bytes that arrive at the host within a duration in seconds."""
    emulation, now = session.emulation, 0.0
    while now < duration and not emulation.ended:
        now = min(now + _FILE_STEP, duration)
        session.advance(now, HostTime())
        file.write(emulation.take(now))
    while (rest := emulation.cable.next_time) < math.inf:
        file.write(emulation.take(rest))


class PacedRun:
    """
    A port on which an emulation runs in real time.

    After a delay of the process the run catches up, so that the pace holds over any time. Drivers
    estimate clocks from the arrival of bytes, so bytes are written before anything else happens.
    """

    def __init__(self, link: str | None, control: 'ControlInput',
                 announce: Callable[[str], None], complain: Callable[[str], None]) -> None:
        """
        Prepare a run; start() creates the port.

        link is the path of a symbolic link to the port, control the source of commands. announce
        is called with the name of each port, complain with the error of a command.
        """
        self.lost = 0           # bytes that a slow reader has missed
        self._link = link
        self._control = control
        self._announce = announce
        self._complain = complain
        self._zero_ns = 0
        self._system_time = SystemTime()
        self._ended = False
        self._port: PtyPort | None = None

    def start(self, wait: bool = False) -> HostTime:
        """
        Create the port and start the time, with wait only when a program opens the port.

        OSError if the port cannot be created.
        """
        port = self._open()
        while wait and not self._ended and not port.wait_until_open(_LONGEST_WAIT):
            pass
        self._zero_ns = time.monotonic_ns()
        return self.host_time()

    def end(self) -> None:
        """Make start() and run() return soon. A signal handler may call this."""
        self._ended = True

    def host_time(self) -> HostTime:
        """Return the host's clocks at time 0; the wall clock may be set meanwhile."""
        return HostTime(self._zero_ns, self._system_time.at(self._zero_ns))

    def run(self, session: Session, duration: float = math.inf) -> None:
        """
        Run until a duration in seconds after the start, or until the session or end() ends it.

        However late the process is, everything due by then happens.
        """
        now = -math.inf
        while not self._ended and now < duration:
            due = min(session.next_time, duration)
            bytes_due = session.emulation.cable.next_time <= due
            ready = self._wait(due - _WATCH if bytes_due else due)
            if bytes_due and not ready:
                self._hand_over(session.emulation.take(self._watched(due)))
            now = min(self._now(), duration)
            self._move_on(session, now, ready)
            self._ended |= session.emulation.ended

    def close(self) -> None:
        """Close the port."""
        if self._port:
            self._port.close()
            self._port = None

    def __enter__(self) -> 'PacedRun':
        """Return the run itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self.close()

    def _now(self) -> float:
        return (time.monotonic_ns() - self._zero_ns) / NS_PER_S

    def _move_on(self, session: Session, now: float, ready: set[int]) -> None:
        zero = self.host_time()
        while not self._try(session.advance, now, zero):
            pass                # the lines after an invalid line of a scenario are due, too
        if self._control.descriptor in ready:
            for line in self._control.lines():
                self._try(session.command, line, now, zero)
        self._follow_plug(session.emulation.plugged(now))
        self._hand_over(session.emulation.take(now))
        if self._port and self._port.fileno() in ready:
            session.receive(self._port.read(), now, zero)

    def _hand_over(self, data: bytes) -> None:
        if self._port:
            self.lost += len(data) - self._port.write_at_once(data)

    def _try(self, action: Callable[..., None], *arguments: object) -> bool:
        try:
            action(*arguments)
        except ControlError as error:
            self._complain(str(error))
            return False
        return True

    def _follow_plug(self, plugged: bool) -> None:
        if not plugged:
            self.close()
        elif not self._port:
            self._open()

    def _open(self) -> PtyPort:
        self._port = PtyPort(self._link)
        self._announce(self._port.name)
        return self._port

    def _wait(self, until: float) -> set[int]:
        """Sleep until a time or until data arrives; return the readable descriptors."""
        files = [] if self._control.descriptor is None else [self._control.descriptor]
        if self._port and self._port.is_open:
            files.append(self._port.fileno())
        timeout = max(0.0, min(until - self._now(), _LONGEST_WAIT))
        poll = select.poll()            # select() fails on descriptors from 1024 on
        for file in files:
            poll.register(file, select.POLLIN)
        # It counts in whole milliseconds.
        ready = {file for file, _ in poll.poll(int(timeout * 1e3))}
        if not ready:
            time.sleep(min(timeout % 1e-3, max(0.0, until - self._now())))
        return ready

    def _watched(self, due: float) -> float:
        """Stay awake until due if that is soon; return the time, at most due."""
        while (now := self._now()) < due <= now + _WATCH:
            pass
        return min(now, due)


class ControlInput:
    """Reads lines from a descriptor, such as a terminal or a pipe, without blocking."""

    def __init__(self, descriptor: int | None) -> None:
        self.descriptor = descriptor
        self._rest = b''

    def lines(self) -> list[str]:
        """Return the complete lines of a readable descriptor."""
        if self.descriptor is None:
            return []
        try:
            data = os.read(self.descriptor, _READ_SIZE)
        except OSError:         # a terminal whose foreground process is another one
            data = b''
        *lines, self._rest = (self._rest + data).split(b'\n')
        if not data:
            self.descriptor = None
            lines = [*lines, self._rest]
        return [line.decode(errors='replace') for line in lines]
