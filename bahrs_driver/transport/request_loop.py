# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The loop that writes requests to a port that another thread reads.

A pure scheduler decides what to send and when: a Poller, or an NvmSession. One thread sleeps until
a request is due, and writes it. The thread that reads the port shares the scheduler: it hands in
answers under `lock`, and then calls send_due(), because an answer usually makes a request due.
To wake the other thread instead cost 8 to 23 % of the rate of a device polled at 921,600 baud,
because that thread waits until the reading thread releases the interpreter. Nothing is written,
and no callback runs, while the lock is held.
"""

import threading
from typing import NamedTuple, Protocol

from bahrs_driver.errors import LinkError
from bahrs_driver.process.host_time import host_instant
from bahrs_driver.units import NS_PER_S

LONGEST_WAIT = 3600.0       # s; a lock does not wait much longer than a century


class RequestScheduler(Protocol):
    """Decides which request is due. Times are in ns of the host's raw clock."""

    def due(self, now: int) -> int | None:
        """Return when to call send(); None if only an event can make a request due."""

    def send(self, now: int) -> bytes:
        """Return the bytes of the next request; empty if none is due."""

    def record_write(self, error: str, now: int) -> None:
        """Record why the latest request was not written; empty if it was."""


class Writer(Protocol):
    """The part of a Link that the loop uses."""

    def write(self, data: bytes, wait: bool = True) -> None:
        """Send all of data. Raise LinkError if the port accepts no more."""


class _Request(NamedTuple):
    """The bytes of a request, and the scheduler that made it."""

    scheduler: RequestScheduler
    data: bytes


class RequestLoop:
    """
    Writes the requests of a scheduler.

    Use the scheduler only while `lock` is held, and notify `changed` after events.
    """

    def __init__(self, link: Writer, scheduler: RequestScheduler | None = None) -> None:
        """Write to a link; the scheduler may be exchanged at any time."""
        self.lock = threading.RLock()
        self.changed = threading.Condition(self.lock)
        self.scheduler = scheduler
        self._link = link
        self._stopping = False

    def run(self) -> None:
        """Write requests when they are due, until stop() is called."""
        while request := self._wait_for_request():
            self._write(*request)

    def stop(self) -> None:
        """Make run() return soon. To be called from another thread."""
        with self.lock:
            self._stopping = True
            self.changed.notify_all()

    def send_due(self) -> None:
        """
        Write the requests that are due, on the calling thread.

        What the port does not accept at once is lost: the calling thread must read the answers.
        """
        while self.scheduler is not None:
            with self.lock:
                request = self._take_request()
            if not request:
                return
            self._write(*request, wait=False)

    def _wait_for_request(self) -> _Request | None:
        """Wait until a request is due, and return it; None after stop()."""
        with self.lock:
            while not self._stopping:
                request = self._take_request()
                if request:
                    return request
                self.changed.wait(self._time_to_next())
        return None

    def _take_request(self) -> _Request | None:
        """Return the request that is due, if any. Hold the lock."""
        scheduler = self.scheduler
        if scheduler is None:
            return None
        data = scheduler.send(now_ns())
        self.changed.notify_all()       # send() may have ended a session
        return _Request(scheduler, data) if data else None

    def _time_to_next(self) -> float | None:
        """Return the seconds until a request may be due; None if no time is set. Hold the lock."""
        now = now_ns()
        due = self.scheduler.due(now) if self.scheduler else None
        return None if due is None else min(LONGEST_WAIT, max(0, due - now) / NS_PER_S)

    def _write(self, scheduler: RequestScheduler, data: bytes, wait: bool = True) -> None:
        error = ''
        try:
            self._link.write(data, wait)
        except LinkError as reason:     # reported by the thread that reads, if the port is gone
            error = str(reason)
        with self.lock:
            scheduler.record_write(error, now_ns())


def now_ns() -> int:
    """Return the time of the host's raw clock, which nothing sets or slews."""
    return host_instant().raw_ns
