# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Run an emulation: as fast as possible into a file, or in real time on a port."""

from collections.abc import Callable
import math
import select
import time
from typing import Protocol

from bahrs_driver.emulator.control_input import ControlInput
from bahrs_driver.emulator.session import EmulationSession
from bahrs_driver.emulator.start_time import StartTime
from bahrs_driver.errors import ControlError
from bahrs_driver.process.host_time import SystemTime
from bahrs_driver.units import NS_PER_S
from bahrs_driver.virtual_serial.pty_port import PtyPort

_LONGEST_WAIT = 0.1     # s
_BUSY_WAIT = 0.0002     # s before bytes are due, in which a sleep may take too long
_FILE_STEP = 1.0        # s of emulated time that are written to a file at once


class ByteSink(Protocol):
    """A file for the bytes of an emulation."""

    def write(self, data: bytes) -> object:
        """Append data."""


def run_to_file(session: EmulationSession, duration: float, file: ByteSink) -> None:
    """Write the bytes that the device sends within a duration in seconds."""
    emulation, now = session.emulation, 0.0
    while now < duration and not emulation.ended:
        now = min(now + _FILE_STEP, duration)
        session.advance(now, StartTime())
        file.write(emulation.take(now))
    while (arrival := emulation.cable.next_time) < math.inf:
        file.write(emulation.take(arrival))


class RealTimeRun:
    """
    A port on which an emulation runs in real time.

    After a delay of the process the run catches up, so its pace is right over any time. Drivers
    estimate clocks from the arrival of bytes, so bytes are written before anything else happens.
    """

    def __init__(self, link: str | None, control: ControlInput,
                 on_port: Callable[[str], None], on_error: Callable[[str], None]) -> None:
        """
        Prepare a run; start() creates the port.

        link is the path of a symbolic link to the port, control the source of commands. on_port
        is called with the name of each port, on_error with the error of each invalid command.
        """
        self.lost = 0           # bytes that a slow reader has missed
        self._link = link
        self._control = control
        self._on_port = on_port
        self._on_error = on_error
        self._start_ns = 0
        self._system_time = SystemTime()
        self._ended = False
        self._port: PtyPort | None = None

    def start(self, wait: bool = False) -> StartTime:
        """
        Create the port and start the time, with wait only when a program opens the port.

        OSError if the port cannot be created.
        """
        port = self._open_port()
        while wait and not self._ended and not port.wait_until_open(_LONGEST_WAIT):
            pass
        self._start_ns = time.monotonic_ns()
        return self.start_time()

    def end(self) -> None:
        """Make start() and run() return soon. A signal handler may call this."""
        self._ended = True

    def start_time(self) -> StartTime:
        """Return the host's clocks at time 0, as the present setting of the wall clock has it."""
        return StartTime(self._start_ns, self._system_time.at(self._start_ns))

    def run(self, session: EmulationSession, duration: float = math.inf) -> None:
        """
        Run until a duration in seconds after the start, or until the session or end() ends it.

        All that is due by then happens, even if the process is late.
        """
        now = -math.inf
        while not self._ended and now < duration:
            due = min(session.next_time, duration)
            bytes_due = session.emulation.cable.next_time <= due
            readable = self._wait(due - _BUSY_WAIT if bytes_due else due)
            if bytes_due and not readable:
                self._write(session.emulation.take(self._busy_wait(due)))
            now = min(self._now(), duration)
            self._advance(session, now, readable)
            self._ended |= session.emulation.ended

    def close(self) -> None:
        """Close the port."""
        if self._port:
            self._port.close()
            self._port = None

    def __enter__(self) -> 'RealTimeRun':
        """Return the run itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the port."""
        self.close()

    def _now(self) -> float:
        return (time.monotonic_ns() - self._start_ns) / NS_PER_S

    def _advance(self, session: EmulationSession, now: float, readable: set[int]) -> None:
        """Advance the emulation to the present, and handle commands and bytes of the host."""
        start_time = self.start_time()
        while not self._succeeds(session.advance, now, start_time):
            pass                # the commands after an invalid one of a scenario are due, too
        if self._control.descriptor in readable:
            for line in self._control.read_lines():
                self._succeeds(session.execute, line, now, start_time)
        self._plug_or_unplug(session.emulation.plugged(now))
        self._write(session.emulation.take(now))
        if self._port and self._port.fileno() in readable:
            session.receive(self._port.read(), now, start_time)

    def _succeeds(self, action: Callable[..., None], *arguments: object) -> bool:
        """Call an action; report a ControlError, and return whether there was none."""
        try:
            action(*arguments)
        except ControlError as error:
            self._on_error(str(error))
            return False
        return True

    def _write(self, data: bytes) -> None:
        if self._port:
            self.lost += len(data) - self._port.write_nowait(data)

    def _plug_or_unplug(self, plugged: bool) -> None:
        if not plugged:
            self.close()
        elif not self._port:
            self._open_port()

    def _open_port(self) -> PtyPort:
        self._port = PtyPort(self._link)
        self._on_port(self._port.name)
        return self._port

    def _wait(self, until: float) -> set[int]:
        """Sleep until a time or until data arrives; return the readable descriptors."""
        poll = select.poll()            # select() fails on descriptors from 1024 on
        if self._control.descriptor is not None:
            poll.register(self._control.descriptor, select.POLLIN)
        if self._port and self._port.is_open:
            poll.register(self._port.fileno(), select.POLLIN)
        timeout = max(0.0, min(until - self._now(), _LONGEST_WAIT))
        # poll() counts whole milliseconds; the rest is slept.
        readable = {descriptor for descriptor, _ in poll.poll(int(timeout * 1e3))}
        if not readable:
            time.sleep(min(timeout % 1e-3, max(0.0, until - self._now())))
        return readable

    def _busy_wait(self, due: float) -> float:
        """Wait without sleeping if due is soon; return the time, at most due."""
        while (now := self._now()) < due <= now + _BUSY_WAIT:
            pass
        return min(now, due)
