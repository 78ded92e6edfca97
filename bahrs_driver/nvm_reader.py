# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Carries an NVM session out on a link that somebody else reads.

Whoever wants pages waits in read(); the receiver's thread hands over what the device says; any
thread may cancel. One session runs at a time.
"""

from collections.abc import Callable, Sequence
import threading
import time
from typing import Any

from bahrs_driver.link import Link, LinkError
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.nvm import NvmSession, PAGES, ServiceFrames, State

LEAVE_TIME = 10.0       # s, far more than a session takes to leave
LOSS_TIME = 3.0         # s, far more than its reader takes to tell why a link is lost


class NvmError(Exception):
    """The pages could not be read. The text says why, and what to do."""


class NvmReader:
    """Reads pages of the non-volatile memory, one request of a user at a time."""

    def __init__(self, link: Link, version: Callable[[], int | None],
                 enter_timeout: float = 30.0, service_frames: ServiceFrames = 'auto') -> None:
        """Take the link, what tells the device's protocol version, and how to ask."""
        self._link = link
        self._version = version
        self._enter_timeout = enter_timeout
        self._service_frames = service_frames
        self._changed = threading.Condition()
        self._session: NvmSession | None = None

    @property
    def busy(self) -> bool:
        """Whether a session runs."""
        return self._session is not None

    @property
    def status(self) -> str:
        """Present state in words."""
        session = self._session
        if session is None:
            return 'none'
        if session.state is State.READING:
            return f'{session.state.value}, {session.progress:.0%} of the pages'
        return str(session.state.value)

    def read(self, pages: Sequence[int] = range(PAGES),
             tell: Callable[[NvmSession], None] = lambda session: None) -> dict[int, bytes]:
        """
        Return the pages by number; NvmError if not all of them could be read.

        tell is called now and then with the session, to show how far it is.
        """
        with self._changed:
            if self._session is not None:
                raise NvmError('another NVM request is under way: wait for it, or cancel it')
            session = self._session = NvmSession(
                pages, time.monotonic(), self._enter_timeout, self._version(),
                self._service_frames)
        try:
            self._carry_out(session, tell)
        finally:
            with self._changed:
                self._session = None
                self._changed.notify_all()
        if session.error:
            raise NvmError(session.error)
        return session.pages

    def receive(self, message: Any, frame: Frame) -> None:
        """Take what the device said."""
        if self._session is None:
            return
        with self._changed:
            if self._session is not None:
                self._session.receive(message, frame.checksum, time.monotonic())
                self._changed.notify_all()

    def cancel(self, reason: str = 'cancelled') -> bool:
        """End the session, after the device was told to leave; False if there is none."""
        with self._changed:
            if self._session is None:
                return False
            self._session.cancel(reason, time.monotonic())
            self._changed.notify_all()
            return True

    def end(self, reason: str) -> None:
        """Cancel, and return once the device was told to leave: the port may be closed then."""
        self.cancel(reason)
        with self._changed:
            self._changed.wait_for(lambda: self._session is None, LEAVE_TIME)

    def lost(self, reason: str) -> None:
        """Take note that the link is gone; the device leaves diagnostics mode by itself."""
        with self._changed:
            if self._session is not None:
                self._session.abandon(reason)
                self._changed.notify_all()

    def _carry_out(self, session: NvmSession, tell: Callable[[NvmSession], None]) -> None:
        try:
            self._converse(session, tell)
        except BaseException:
            # Ctrl-C, too: the device must not be left alone in its mode.
            session.cancel('interrupted', time.monotonic())
            self._converse(session, lambda _: None)
            raise

    def _converse(self, session: NvmSession, tell: Callable[[NvmSession], None]) -> None:
        with self._changed:
            while session.state is not State.FINISHED:
                data = session.send(time.monotonic())
                if data:
                    self._write(session, data)
                tell(session)
                self._changed.wait(max(0.0, session.due - time.monotonic()))

    def _write(self, session: NvmSession, data: bytes) -> None:
        try:
            self._link.write(data)
        except LinkError as error:
            # The reader of a link that is lost knows why, and what to do; it may be a bit later.
            self._changed.wait_for(lambda: session.state is State.FINISHED, LOSS_TIME)
            session.abandon(str(error))
