# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Where an emulation meets real time: as fast as it goes into a file, or paced on a port."""

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
_WATCH = 0.0002         # s before bytes are due, from when on we do not trust to be woken in time
_READ_SIZE = 4096
_FILE_STEP = 1.0        # s of emulated time that go into a file at once


class Output(Protocol):
    """What the bytes of an emulation are written to."""

    def write(self, data: bytes) -> object:
        """Append data."""


def run_to_file(session: Session, duration: float, file: Output) -> None:
    """Write what arrives at the host in some seconds, as fast as it can be made."""
    emulation, now = session.emulation, 0.0
    while now < duration and not emulation.ended:
        now = min(now + _FILE_STEP, duration)
        session.advance(now, HostTime())
        file.write(emulation.take(now))
    while (rest := emulation.cable.next_time) < math.inf:
        file.write(emulation.take(rest))


class PacedRun:
    """
    A port on which an emulation goes on in real time.

    Whatever makes the process late is caught up with, so that the pace holds over any time. A
    driver may judge its clock by when bytes come, so they are handed over before anything else.
    """

    def __init__(self, link: str | None, control: 'ControlInput',
                 announce: Callable[[str], None], complain: Callable[[str], None]) -> None:
        """
        Take what start() and run() need.

        link is a path to make a symbolic link to the port at, control where commands come from,
        announce is told every port's name, and complain what is wrong with a command.
        """
        self.lost = 0           # bytes that a reader was too slow for
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
        Make the port and let time begin, once somebody has opened it if asked to wait for that.

        OSError if the port cannot be made.
        """
        port = self._open()
        while wait and not self._ended and not port.wait_until_open(_LONGEST_WAIT):
            pass
        self._zero_ns = time.monotonic_ns()
        return self.host_time()

    def end(self) -> None:
        """Let start() and run() return soon. A signal handler may call it."""
        self._ended = True

    def host_time(self) -> HostTime:
        """Return what the host's clocks read at time 0; the wall clock's may change."""
        return HostTime(self._zero_ns, self._system_time.at(self._zero_ns))

    def run(self, session: Session, duration: float = math.inf) -> None:
        """
        Go on until so many seconds after the start, or until the session or end() ends it.

        However late the process is, all that is due by then is done.
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
        """Take the port away."""
        if self._port:
            self._port.close()
            self._port = None

    def __enter__(self) -> 'PacedRun':
        """Return the run itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Take the port away."""
        self.close()

    def _now(self) -> float:
        return (time.monotonic_ns() - self._zero_ns) / NS_PER_S

    def _move_on(self, session: Session, now: float, ready: set[int]) -> None:
        zero = self.host_time()
        while not self._try(session.advance, now, zero):
            pass                # what follows a wrong line of a scenario is due, too
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
        """Sleep until then, or until somebody sends something; return the descriptors it is on."""
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
        """Stay awake until then if that is soon; return the time, at most due."""
        while (now := self._now()) < due <= now + _WATCH:
            pass
        return min(now, due)


class ControlInput:
    """Lines from a descriptor that may take their time, such as a terminal or a pipe."""

    def __init__(self, descriptor: int | None) -> None:
        self.descriptor = descriptor
        self._rest = b''

    def lines(self) -> list[str]:
        """Return the lines that have come, once there is something to read."""
        if self.descriptor is None:
            return []
        try:
            data = os.read(self.descriptor, _READ_SIZE)
        except OSError:         # a terminal that does not talk to us in the background
            data = b''
        *lines, self._rest = (self._rest + data).split(b'\n')
        if not data:
            self.descriptor = None
            lines = [*lines, self._rest]
        return [line.decode(errors='replace') for line in lines]
