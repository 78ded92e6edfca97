# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Reading the non-volatile memory of a BAHRS over a link that another thread reads.

The request loop carries out one session at a time. The caller of read() waits for it, the thread
that reads the link hands in the messages of the device, and any thread may cancel it. Every
session ends, because it has time limits of its own and end() has one.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from bahrs_driver.errors import NvmError
from bahrs_driver.protocol.bahrs.nvm_session import NvmSession, PAGES, ServiceFrames, SessionState
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.transport.request_loop import now_ns, RequestLoop
from bahrs_driver.units import NS_PER_S

LEAVE_TIME = 0.3        # s; longest wait for the device to leave its mode when the program ends

OnPage = Callable[[int, bytes], None]
OnProgress = Callable[[NvmSession], None]


class SessionOptions(NamedTuple):
    """Options of a session, as in the parameters nvm.*."""

    enter_timeout: float = 30.0         # s
    service_frames: ServiceFrames = 'auto'


def _ignore(*_: object) -> None:
    """Do nothing."""


class NvmReader:
    """Reads pages of the non-volatile memory, one request of a user at a time."""

    def __init__(self, loop: RequestLoop, version: Callable[[], int | None]) -> None:
        """Send on a loop; version returns the protocol version of the device, if known."""
        self.loop = loop
        self._version = version
        self._session: NvmSession | None = None
        self._ended = ''            # reason why no more sessions may begin

    @property
    def status(self) -> str:
        """Present state for the user; 'none' without a session."""
        session = self._session
        if session is None:
            return 'none'
        if session.state is SessionState.READING:
            return f'{session.state.value}, {session.progress:.0%} of the pages'
        return str(session.state.value)

    def read(self, pages: Sequence[int] = range(PAGES),
             options: SessionOptions = SessionOptions(), on_page: OnPage = _ignore,
             on_progress: OnProgress = _ignore) -> dict[int, bytes]:
        """
        Return the pages by number. Raise NvmError if not all of them could be read.

        on_page is called with number and data of each page when it was read, on_progress with the
        session after each change, both in the calling thread.
        """
        session = self._begin(pages, options)
        try:
            self._follow(session, on_page, on_progress)
        except BaseException:
            # Also Ctrl-C: the device must leave its mode.
            with self.loop.lock:
                session.cancel('interrupted', now_ns())
                self.loop.lock.notify_all()
                self.loop.lock.wait_for(lambda: session.finished)
            raise
        finally:
            with self.loop.lock:
                self._session = self.loop.scheduler = None
                self.loop.lock.notify_all()
        if session.error:
            raise NvmError(session.error)
        return session.pages

    def receive(self, message: Message, frame: Frame) -> None:
        """Hand in a message of the device."""
        if self._session is None:
            return
        with self.loop.lock:
            if self._session is not None:
                self._session.receive(message, frame.checksum, now_ns())
                self.loop.lock.notify_all()

    def cancel(self, reason: str = 'cancelled') -> bool:
        """Make the session leave diagnostics mode and end; return False if there is none."""
        with self.loop.lock:
            if self._session is None:
                return False
            self._session.cancel(reason, now_ns())
            self.loop.lock.notify_all()
            return True

    def end(self, reason: str, timeout: float = LEAVE_TIME) -> None:
        """
        Cancel the session, let no other begin, and wait until the device has left its mode.

        The session is abandoned after timeout seconds; the port may be closed then.
        """
        self._ended = reason
        self.cancel(reason)
        with self.loop.lock:
            if not self.loop.lock.wait_for(lambda: self._session is None, timeout):
                self._abandon(reason)

    def lost(self, reason: str) -> None:
        """End the session: the link is lost, and the device leaves diagnostics mode by itself."""
        with self.loop.lock:
            self._abandon(reason)

    def _begin(self, pages: Sequence[int], options: SessionOptions) -> NvmSession:
        with self.loop.lock:
            if self._ended:
                raise NvmError(self._ended)
            if self._session is not None:
                raise NvmError('another NVM request is under way: wait for it, or cancel it')
            session = NvmSession(
                pages, now_ns(), round(options.enter_timeout * NS_PER_S), self._version(),
                options.service_frames)
            self._session = self.loop.scheduler = session
            self.loop.lock.notify_all()
            return session

    def _follow(self, session: NvmSession, on_page: OnPage, on_progress: OnProgress) -> None:
        """Call back for each change of a session until it has ended."""
        state, delivered = None, 0
        while state is not SessionState.FINISHED:
            with self.loop.lock:
                self.loop.lock.wait_for(
                    lambda: (session.state, len(session.pages)) != (state, delivered))
                state, pages = session.state, list(session.pages.items())
            for number, page in pages[delivered:]:
                on_page(number, page)
            delivered = len(pages)
            on_progress(session)

    def _abandon(self, reason: str) -> None:
        if self._session is not None:
            self._session.abandon(reason)
            self.loop.lock.notify_all()
