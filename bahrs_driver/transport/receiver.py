# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The one thread that reads: read, feed, decode, stamp, hand over.

It keeps the port open as long as it runs. When the port cannot be opened or is lost it says so
once, and tries again with growing pauses, until it is stopped. A fault of the driver itself, in
whatever is made of the bytes, is logged and counted, and costs what it happened to and no more.
"""

from collections.abc import Iterator
from dataclasses import dataclass
import threading
import time
from typing import Any, Protocol

from bahrs_driver.clock import Clock, Stamped
from bahrs_driver.process.fault_log import FaultLog
from bahrs_driver.protocol.framing import Frame, Framer
from bahrs_driver.transport.link import Link, LinkError, Reading

FIRST_PAUSE = 0.1       # s, before the port is tried again
LONGEST_PAUSE = 2.0     # s
STEADY = 2.0            # s that a port without frames must stay open to be called open again
SAMPLE_SIZE = 256       # bytes kept to find out what a stream without frames may be
READING = 'reading the port'


Received = Stamped


class Codec(Protocol):
    """What turns a frame into a message."""

    def decode(self, frame: Frame) -> Any:
        """Return the message of an intact frame."""


class Listener(Protocol):
    """What receives the events of the link, on the receiver's thread."""

    def link_opened(self) -> None:
        """Begin another stream: the port was opened."""

    def link_usable(self) -> None:
        """Report that the port is open; not called for one that is lost again at once."""

    def link_failed(self, reason: str, known: bool) -> None:
        """
        End the stream, and report why the port cannot be opened, or was lost.

        If the reason is known, it was reported before, and only a stream has ended.
        """

    def bytes_read(self, reading: Reading) -> None:
        """Handle the bytes of a read, before anything is made of them."""

    def nothing_read(self) -> None:
        """Handle a read that timed out without a byte."""

    def received(self, batch: list[Received]) -> None:
        """Handle the messages whose time is known since the last read."""

    def time_changed(self, sentence: str) -> None:
        """Report a change of a clock: the host's, the device's, or its pulses."""


@dataclass
class LinkCounters:
    """What happened on the link so far. Written by the receiver, read by anyone."""

    open_since: float | None = None         # time.monotonic()
    last_data: float | None = None          # time.monotonic()
    times_opened: int = 0
    bytes_received: int = 0
    reads: int = 0
    last_bytes: bytes = b''                 # the latest few, as they came
    error: str = ''                         # why it is not open now
    last_error: str = ''                    # the latest of all


class Receiver:
    """Reads a link until stopped, and hands all that it makes of the bytes to a listener."""

    def __init__(self, link: Link, framer: Framer, codec: Codec, clock: Clock,
                 listener: Listener, faults: FaultLog) -> None:
        self.counters = LinkCounters()
        self._link = link
        self._framer = framer
        self._codec = codec
        self._listener = listener
        self._clock = clock
        self._faults = faults
        self._pause = FIRST_PAUSE
        self._absence_reported = False
        self._opened_at: float | None = None        # time.monotonic(); None while closed
        self._has_frames = False        # since it was opened
        self._flapping = False          # the latest opening was lost at once, without a frame
        self._stopping = threading.Event()

    def stop(self) -> None:
        """Make run() return soon, the port closed. To be called from another thread."""
        self._stopping.set()
        self._faults.survive('waking the reader', self._link.cancel_read)

    def run(self) -> None:
        """Keep the port open and read it, until stopped."""
        while not self._stopping.is_set():
            try:
                self._open()
                self._read_on()
            except LinkError as error:
                self._recover(error)
            except Exception as error:
                self._faults.report(READING, error)
                self._recover(LinkError(f'{self._link.name} is opened again after a fault of the '
                                        'driver'))
            finally:
                self._faults.survive('closing the port', self._link.close)

    def _open(self) -> None:
        self._link.connect()
        self._clock.begin(self._link.byte_time_ns)
        self._opened_at, self._has_frames = time.monotonic(), False
        self.counters.times_opened += 1
        self._faults.survive('beginning a stream', self._listener.link_opened)
        if not self._flapping:
            self._report_open()

    def _report_open(self) -> None:
        """Report that the port is open, once for each opening."""
        if self.counters.open_since is None:
            self.counters.open_since = self._opened_at
            self.counters.error = ''
            self._absence_reported = False
            self._faults.survive('reporting that the port is open', self._listener.link_usable)

    def _read_on(self) -> None:
        while not self._stopping.is_set():
            reading = self._link.read()
            if reading is None:
                self._faults.survive('noticing silence', self._listener.nothing_read)
            else:
                self._take(reading)
            if self._open_for() >= STEADY:
                self._report_open()

    def _open_for(self) -> float:
        return 0.0 if self._opened_at is None else time.monotonic() - self._opened_at

    def _take(self, reading: Reading) -> None:
        self._faults.survive('handing out bytes', self._listener.bytes_read, reading)
        self.counters.reads += 1
        self.counters.bytes_received += len(reading.data)
        self.counters.last_bytes = (self.counters.last_bytes + reading.data)[-SAMPLE_SIZE:]
        self.counters.last_data = time.monotonic()
        try:
            frames = self._framer.feed(reading.data)
            if frames:          # a port that opens and closes at once is not tried any faster
                self._pause, self._has_frames = FIRST_PAUSE, True
                self._report_open()
            self._clock.observe_read(reading.now, self._framer.received)
            self._hand_over(self._stamped(frames))
        except Exception as error:
            # What waits in the clock may be what it failed on.
            self._faults.report(READING, error)
            self._clock.begin(self._link.byte_time_ns)

    def _stamped(self, frames: list[Frame]) -> list[Received]:
        return self._clock.stamp(list(self._decoded(frames)))

    def _decoded(self, frames: list[Frame]) -> Iterator[tuple[Any, Frame]]:
        for frame in frames:
            try:
                yield self._codec.decode(frame), frame
            except Exception as error:
                self._faults.report('decoding a frame', error)

    def _hand_over(self, batch: list[Received]) -> None:
        for sentence in self._clock.take_notices():
            self._faults.survive('reporting a change of time', self._listener.time_changed,
                                 sentence)
        if batch:
            self._faults.survive('handing out messages', self._listener.received, batch)

    def _recover(self, error: LinkError) -> None:
        """Close the port, report why, and wait before it is tried again."""
        # First, for a port that is held open comes back under another name.
        self._faults.survive('closing the port', self._link.close)
        was_open = self._opened_at is not None
        if was_open:
            # Such as a server whose only connection is taken, which hangs up on all others.
            self._flapping = not self._has_frames and self._open_for() < STEADY
            self._opened_at = self.counters.open_since = None
            self._faults.survive('ending a stream', self._end_stream)
        if self._stopping.is_set():         # which is why it failed
            return
        self._fail(error, was_open)
        self._stopping.wait(self._pause)
        self._pause = min(2 * self._pause, LONGEST_PAUSE)

    def _end_stream(self) -> None:
        self._hand_over(self._stamped(self._framer.flush()) + self._clock.end())

    def _fail(self, error: LinkError, was_open: bool) -> None:
        reason = str(error)
        known = reason == self.counters.error or (error.absent and self._absence_reported)
        self._absence_reported = error.absent
        self.counters.error = self.counters.last_error = reason
        if was_open or not known:
            self._faults.survive('reporting that the port is not open',
                                 self._listener.link_failed, reason, known)
