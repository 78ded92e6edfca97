# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Carries an NVM session out on a link that another thread reads.

The thread that wants pages waits in read(); the receiver's thread hands over the device's
messages; any thread may cancel. One session runs at a time, and each one ends: the session has a
time limit, a write has one, and end() has one of its own.
"""

from collections.abc import Callable, Sequence
import threading
import time
from typing import Any, NamedTuple

from bahrs_driver.errors import NvmError
from bahrs_driver.protocol.bahrs.nvm_session import NvmSession, PAGES, ServiceFrames, State
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.transport.link import Link, LinkError

LEAVE_TIME = 0.3        # s that the end of the program waits for the device to leave
LOSS_TIME = 3.0         # s, far more than the receiver takes to find out why a link is lost

OnPage = Callable[[int, bytes], None]
OnProgress = Callable[[NvmSession], None]


class SessionOptions(NamedTuple):
    """How the device is asked, as the parameters nvm.* say."""

    enter_timeout: float = 30.0
    service_frames: ServiceFrames = 'auto'


def _ignore(*_: object) -> None:
    """Do nothing."""


class NvmReader:
    """Reads pages of the non-volatile memory, one request of a user at a time."""

    def __init__(self, link: Link, version: Callable[[], int | None]) -> None:
        """Take the link, and a callable that returns the device's protocol version, if known."""
        self._link = link
        self._version = version
        self._changed = threading.Condition()
        self._session: NvmSession | None = None
        self._ended = ''            # why no session may begin any more

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
             options: SessionOptions = SessionOptions(), on_page: OnPage = _ignore,
             on_progress: OnProgress = _ignore) -> dict[int, bytes]:
        """
        Return the pages by number; NvmError if not all of them could be read.

        on_page is called with number and data of each page as soon as it was read, on_progress now
        and then with the session, both in the thread that called read().
        """
        with self._changed:
            if self._ended:
                raise NvmError(self._ended)
            if self._session is not None:
                raise NvmError('another NVM request is under way: wait for it, or cancel it')
            session = self._session = NvmSession(
                pages, time.monotonic(), options.enter_timeout, self._version(),
                options.service_frames)
        try:
            self._carry_out(session, on_page, on_progress)
        finally:
            with self._changed:
                self._session = None
                self._changed.notify_all()
        if session.error:
            raise NvmError(session.error)
        return session.pages

    def receive(self, message: Any, frame: Frame) -> None:
        """Hand a message of the device to the session, if there is one."""
        if self._session is None:
            return
        with self._changed:
            if self._session is not None:
                self._session.receive(message, frame.checksum, time.monotonic())
                self._changed.notify_all()

    def cancel(self, reason: str = 'cancelled') -> bool:
        """Make the session leave diagnostics mode and end; False if there is none."""
        with self._changed:
            if self._session is None:
                return False
            self._session.cancel(reason, time.monotonic())
            self._changed.notify_all()
            return True

    def end(self, reason: str, timeout: float = LEAVE_TIME) -> None:
        """
        Cancel the session and let none begin; return once the device has left its mode.

        After a timeout in seconds the device is left to itself; the port may be closed then.
        """
        self._ended = reason
        self.cancel(reason)
        with self._changed:
            if not self._changed.wait_for(lambda: self._session is None, timeout):
                self._abandon(reason)

    def lost(self, reason: str) -> None:
        """End the session: the link is gone, and the device leaves diagnostics mode alone."""
        with self._changed:
            self._abandon(reason)

    def _abandon(self, reason: str) -> None:
        if self._session is not None:
            self._session.abandon(reason)
            self._changed.notify_all()

    def _carry_out(self, session: NvmSession, on_page: OnPage, on_progress: OnProgress) -> None:
        try:
            self._converse(session, on_page, on_progress)
        except BaseException:
            # Ctrl-C, too: the device must not be left alone in its mode.
            with self._changed:
                session.cancel('interrupted', time.monotonic())
            self._converse(session, _ignore, _ignore)
            raise

    def _converse(self, session: NvmSession, on_page: OnPage, on_progress: OnProgress) -> None:
        # Without the lock whenever something else may take its time, which must not hold up the
        # thread that reads the link.
        handed_over = 0
        while True:
            with self._changed:
                data = session.send(time.monotonic())
                pages = list(session.pages.items())
            if data:
                self._write(session, data)
            for number, page in pages[handed_over:]:
                on_page(number, page)
            handed_over = len(pages)
            on_progress(session)
            with self._changed:
                if session.state is State.FINISHED and len(session.pages) == handed_over:
                    return
                if len(session.pages) == handed_over:
                    self._changed.wait(max(0.0, session.due - time.monotonic()))

    def _write(self, session: NvmSession, data: bytes) -> None:
        try:
            self._link.write(data)
        except LinkError as error:
            # The receiver of a lost link knows why, and what to do; it may be a bit later.
            with self._changed:
                self._changed.wait_for(lambda: session.state is State.FINISHED, LOSS_TIME)
                session.abandon(str(error))
