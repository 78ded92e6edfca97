# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Carries on a conversation with a device that speaks only when it is asked.

A thread of its own writes the requests when their time comes, and sleeps in between. The
receiver's thread hands in the frames that come, as to any codec, and gets answers that say when
they were asked for; what could only wait for an answer is written then and there. What to say,
and when, is the conversation's business.
"""

from collections.abc import Collection
import threading
from typing import Any, Protocol

from bahrs_driver.process.host_time import host_instant
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.transport.link import Link, LinkError
from bahrs_driver.units import NS_PER_S

LONGEST_SLEEP = 3600.0      # s; longer ones are beyond what a lock can wait for


class Conversation(Protocol):
    """What to ask a device, and when. Times are of the host's raw clock, in ns."""

    def begin(self, now: int, byte_time: int) -> None:
        """Begin on an open line, on which a byte takes byte_time ns."""

    def end(self) -> None:
        """End: the line is gone."""

    def due(self, now: int) -> int | None:
        """Return when to call send(); None is when an answer has come, or never."""

    def send(self, now: int) -> bytes:
        """Return what to send now, if anything."""

    def receive(self, frame: Frame, now: int) -> Any:
        """Take a frame that has come, and return its message."""

    def expected(self) -> Collection[Any]:
        """Return what is waited for."""


class Requester:
    """Lets a conversation use a link that somebody else reads."""

    def __init__(self, link: Link, conversation: Conversation) -> None:
        self._link = link
        self._conversation = conversation
        self._changed = threading.Condition()
        self._stopping = False
        self.write_error = ''       # why the latest request was not written; '' if it was

    def opened(self) -> None:
        """Begin to ask: the link is open."""
        self.write_error = ''
        with self._changed:
            self._conversation.begin(_raw_time(), self._link.byte_time_ns)
            self._changed.notify()

    def lost(self) -> None:
        """Ask nothing more: the link is gone."""
        with self._changed:
            self._conversation.end()
        self.write_error = ''

    def decode(self, frame: Frame, _now: int = 0) -> Any:
        """
        Return the message of a frame that has come, having sent what is due now that it has.

        So the line is busy again before anything is made of the message. What the device does not
        accept at once is lost, for its answers are read on this thread.
        """
        with self._changed:
            message = self._conversation.receive(frame, _raw_time())
            data = self._conversation.send(_raw_time())
            self._changed.notify()
        self._write(data, wait=False)
        return message

    def expected(self) -> Collection[Any]:
        """Return what is waited for."""
        with self._changed:
            return self._conversation.expected()

    def run(self) -> None:
        """Write what is due, until stopped."""
        while data := self._next():
            self._write(data)

    def stop(self) -> None:
        """Make run() return soon. To be called from another thread."""
        with self._changed:
            self._stopping = True
            self._changed.notify()

    def _write(self, data: bytes, wait: bool = True) -> None:
        # A link that is lost is reported by its reader, and a request that is lost is repeated.
        if not data:
            return
        try:
            self._link.write(data, wait)
            self.write_error = ''
        except LinkError as error:
            self.write_error = str(error)

    def _next(self) -> bytes:
        """Sleep until something is to be sent; empty when stopped."""
        with self._changed:
            while not self._stopping:
                data = self._conversation.send(_raw_time())
                if data:
                    return data
                present = _raw_time()
                due = self._conversation.due(present)
                self._changed.wait(None if due is None else min(
                    LONGEST_SLEEP, max(0, due - present) / NS_PER_S))
            return b''


def _raw_time() -> int:
    return host_instant().raw_ns
