# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The loop that reads the port: read, feed the pipeline, yield the events.

The loop is a generator, so the thread that consumes the events runs it. It keeps the port open
until it is stopped. If the port cannot be opened or is lost, it yields the reason once and tries
again, with pauses that grow. A port that opens but is lost at once again and again is reported as
usable only when it delivers a frame or stays open for STABLE_TIME. An exception in the pipeline is
a fault of the driver: it is logged and counted, and reading continues.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
import threading
import time
from typing import Any

from bahrs_driver.errors import LinkError
from bahrs_driver.pipeline import Event, Pipeline
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.transport.channel import Reading
from bahrs_driver.transport.link import Link
from bahrs_driver.transport.port_events import (
    BytesRead, Connection, PortEvent, PortOpened, PortUnavailable, PortUsable, Silence,
    StreamEnded,
)

FIRST_PAUSE = 0.1       # s, before the port is tried again
LONGEST_PAUSE = 2.0     # s
STABLE_TIME = 2.0       # s after which an open port is usable even without frames
READING = 'reading the port'


@dataclass
class LinkCounters:
    """What happened on the link so far. The reader writes them, any thread may read them."""

    open_since: float | None = None         # time.monotonic(), if the port is usable
    last_data: float | None = None          # time.monotonic()
    times_opened: int = 0
    error: str = ''                         # why the port is not open now
    last_error: str = ''


class PortReader:
    """Reads a link through a pipeline until stop() is called."""

    def __init__(self, link: Link, pipeline: Pipeline, faults: FaultLog,
                 lock: AbstractContextManager[object] = nullcontext()) -> None:
        """Hold the lock while the pipeline works; report unexpected exceptions to faults."""
        self.counters = LinkCounters()
        self._link = link
        self._pipeline = pipeline
        self._faults = faults
        self._lock = lock
        self._pause = FIRST_PAUSE
        self._absence_reported = False
        self._connection = Connection(0, 0)
        self._opened_at: float | None = None        # time.monotonic(); None while closed
        self._has_frames = False        # of this connection
        self._flapping = False          # the last connection was lost at once, without a frame
        self._stopping = threading.Event()

    def stop(self) -> None:
        """Make events() close the port and end soon. Any thread may call it."""
        self._stopping.set()
        self._faults.survive('waking the reader', self._link.cancel)

    def events(self) -> Iterator[PortEvent]:
        """Keep the port open and read it until stop() is called; yield what happens."""
        while not self._stopping.is_set():
            failure = None
            try:
                yield from self._open()
                yield from self._read()
            except LinkError as error:
                failure = error
            except Exception as error:
                self._faults.report(READING, error)
                failure = LinkError(f'{self._link.name} is opened again after a fault of the '
                                    'driver')
            finally:
                # Before the pause: while its old file is open, an adapter returns as another.
                self._faults.survive('closing the port', self._link.close)
            if failure:
                yield from self._recover(failure)

    def _open(self) -> Iterator[PortEvent]:
        self._link.connect()
        with self._lock:
            self._pipeline.open(self._link.byte_time_ns)
        self._opened_at, self._has_frames = time.monotonic(), False
        self.counters.times_opened += 1
        self._connection = Connection(self.counters.times_opened, self._link.byte_time_ns)
        yield PortOpened(self._connection)
        if not self._flapping:
            yield from self._report_usable()

    def _report_usable(self) -> Iterator[PortEvent]:
        if self.counters.open_since is None:
            self.counters.open_since = self._opened_at
            self.counters.error = ''
            self._absence_reported = False
            yield PortUsable(self._connection)

    def _read(self) -> Iterator[PortEvent]:
        while not self._stopping.is_set():
            reading = self._link.read()
            if reading is None:
                yield Silence()
            else:
                events = self._feed(reading)
                if self.counters.open_since is None and self._has_frames:
                    yield from self._report_usable()
                yield BytesRead(reading, self._connection, events)
            if self.counters.open_since is None and self._open_for() >= STABLE_TIME:
                yield from self._report_usable()

    def _open_for(self) -> float:
        return 0.0 if self._opened_at is None else time.monotonic() - self._opened_at

    def _feed(self, reading: Reading) -> Sequence[Event] | None:
        """Return the events of a read; None if there are none and no frame was complete."""
        self.counters.last_data = time.monotonic()
        framing = self._pipeline.counters.framing
        frames_before = framing.frames
        events = self._run_step(self._pipeline.feed, *reading)
        if framing.frames > frames_before:  # without, a port that flaps keeps its longer pause
            self._pause, self._has_frames = FIRST_PAUSE, True
            return events
        return events or None

    def _run_step(self, step: Callable[..., Sequence[Event]], *arguments: Any
                  ) -> Sequence[Event]:
        """Return the events of a step of the pipeline; none if it fails."""
        try:
            with self._lock:
                return step(*arguments)
        except Exception as error:
            self._faults.report(READING, error)
            return ()

    def _recover(self, failure: LinkError) -> Iterator[PortEvent]:
        """End the stream, yield the reason, and pause."""
        was_open = self._opened_at is not None
        if was_open:
            # For example, a server with room for one client hangs up on a second one at once.
            self._flapping = not self._has_frames and self._open_for() < STABLE_TIME
            self._opened_at = self.counters.open_since = None
            if events := self._run_step(self._pipeline.close):
                yield StreamEnded(events)
        if self._stopping.is_set():         # stop() caused the failure
            return
        yield from self._report_failure(failure, was_open)
        self._stopping.wait(self._pause)
        self._pause = min(2 * self._pause, LONGEST_PAUSE)

    def _report_failure(self, failure: LinkError, was_open: bool) -> Iterator[PortEvent]:
        reason = str(failure)
        reported = reason == self.counters.error or (failure.absent and self._absence_reported)
        self._absence_reported = failure.absent
        self.counters.error = self.counters.last_error = reason
        if was_open or not reported:
            yield PortUnavailable(reason, reported)
