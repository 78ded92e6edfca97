# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Read the non-volatile memory of a BAHRS over a link that another thread reads.

Three threads share a session: the request loop writes its requests, the thread that reads the link
passes the messages of the device to receive(), and the caller of read() waits. Any thread may
cancel it. Every session ends, because each of its states and end() have time limits.
"""

from collections.abc import Callable, Sequence

from bahrs_driver.devices.nvm_settings import NvmSettings
from bahrs_driver.errors import NvmError
from bahrs_driver.protocol.bahrs.nvm_session import NvmSession, PAGES, SessionState
from bahrs_driver.protocol.framing import Frame
from bahrs_driver.protocol.message import Message
from bahrs_driver.transport.request_loop import now_ns, RequestLoop
from bahrs_driver.units import NS_PER_S

LEAVE_TIME = 0.3        # s; longest wait for the device to leave its mode when the program ends

OnPage = Callable[[int, bytes], None]
OnProgress = Callable[[NvmSession], None]


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
        """State of the session, for the user; 'none' without a session."""
        session = self._session
        if session is None:
            return 'none'
        if session.state is SessionState.READING:
            return f'{session.state.value}, {session.progress:.0%} of the pages'
        return str(session.state.value)

    def read(self, pages: Sequence[int] = range(PAGES),
             settings: NvmSettings = NvmSettings(), on_page: OnPage = _ignore,
             on_progress: OnProgress = _ignore) -> dict[int, bytes]:
        """
        Read pages and return them by number; NvmError unless all of them were read.

        Both callbacks run in the calling thread: on_page with number and data of each page,
        on_progress with the session after each change.
        """
        session = self._begin(pages, settings)
        try:
            self._follow(session, on_page, on_progress)
        except BaseException:           # even after Ctrl-C, the device must leave its mode
            self._interrupt(session)
            raise
        finally:
            self._set_session(None)
        if session.error:
            raise NvmError(session.error)
        return session.pages

    @property
    def reading(self) -> bool:
        """Whether there is a session, which needs all messages."""
        return self._session is not None

    def receive(self, message: Message, frame: Frame) -> None:
        """Pass a message of the device to the session, if there is one."""
        with self.loop.lock:
            if self._session is not None:
                self._session.receive(message, frame.checksum, now_ns())
                self.loop.changed.notify_all()

    def cancel(self, reason: str = 'cancelled') -> bool:
        """Make the session leave diagnostics mode and end; return False if there is none."""
        with self.loop.lock:
            if self._session is None:
                return False
            self._session.cancel(reason, now_ns())
            self.loop.changed.notify_all()
            return True

    def end(self, reason: str, timeout: float = LEAVE_TIME) -> None:
        """
        Cancel the session, refuse new ones, and wait until the device has left diagnostics mode.

        After timeout seconds, abandon the session. The port may be closed afterwards.
        """
        self._ended = reason
        self.cancel(reason)
        with self.loop.lock:
            if not self.loop.changed.wait_for(lambda: self._session is None, timeout):
                self.abandon(reason)

    def abandon(self, reason: str) -> None:
        """End the session at once. Without a link, the device leaves its mode by itself."""
        with self.loop.lock:
            if self._session is not None:
                self._session.abandon(reason)
                self.loop.changed.notify_all()

    def _begin(self, pages: Sequence[int], settings: NvmSettings) -> NvmSession:
        with self.loop.lock:
            if self._ended:
                raise NvmError(self._ended)
            if self._session is not None:
                raise NvmError('another NVM request is under way: wait for it, or cancel it')
            session = NvmSession(
                pages, now_ns(), round(settings.enter_timeout * NS_PER_S), self._version(),
                settings.service_frames)
            self._set_session(session)
            return session

    def _set_session(self, session: NvmSession | None) -> None:
        with self.loop.lock:
            self._session = self.loop.scheduler = session
            self.loop.changed.notify_all()

    def _interrupt(self, session: NvmSession) -> None:
        """Cancel a session, and wait until the device has left diagnostics mode."""
        with self.loop.lock:
            session.cancel('interrupted', now_ns())
            self.loop.changed.notify_all()
            self.loop.changed.wait_for(lambda: session.finished)

    def _follow(self, session: NvmSession, on_page: OnPage, on_progress: OnProgress) -> None:
        """Call back for each change of a session until it has ended."""
        state, delivered = None, 0
        while state is not SessionState.FINISHED:
            with self.loop.lock:
                self.loop.changed.wait_for(
                    lambda: (session.state, len(session.pages)) != (state, delivered))
                state, pages = session.state, list(session.pages.items())
            for number, page in pages[delivered:]:
                on_page(number, page)
            delivered = len(pages)
            on_progress(session)
