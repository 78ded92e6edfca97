# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Reading the non-volatile memory of a BAHRS: a diagnostics session as a state machine.

The session receives messages and times, and returns the bytes to send; it reads no clock and
writes to no port. It only reads: the protocol has no message that writes to the memory.

    ENTERING   requests to enter, repeatedly, until the device accepts or the time is up
    READING    requests one page after another, again if an answer is late or damaged
    LEAVING    requests to leave, until the device accepts, streams again, or does not answer
    FINISHED   all pages are in `pages`, or `error` has the reason why they are not

Known firmware accepts a request to enter only within half a second of power-on. So the session
repeats it for a long time, and the user must switch the device off and on. Devices differ in the
padding and CRC of service frames (see frames), so the session tries all variants; the CRC of the
answer shows the right one. If the device streams during READING, it has left the mode or was
restarted, and the session enters the mode again, a few times. If it does not answer a request to
leave, it leaves the mode by itself five seconds after the last request.

Every session ends, because entering, reading and leaving have time limits.
"""

from collections.abc import Sequence
from enum import Enum
from itertools import cycle
from typing import Literal, NamedTuple

from bahrs_driver.protocol.bahrs.frames import BahrsCodec, Checksum
from bahrs_driver.protocol.bahrs.messages import (
    Acknowledgement,
    BahrsMessage,
    EnterDiagnostics,
    ExitDiagnostics,
    Inertial,
    NvmPage,
    NvmReadRequest,
    VERSIONS,
)
from bahrs_driver.protocol.message import Message
from bahrs_driver.units import NS_PER_MS, NS_PER_S

PAGES = 250
PAGE_SIZE = 32

# Times are in ns.
ENTER_TIMEOUT = 30 * NS_PER_S
ENTER_INTERVAL = 50 * NS_PER_MS       # between requests to enter
ANSWER_TIMEOUT = 100 * NS_PER_MS      # twice what a page, a slow device and an adapter need
READ_TIME = 10 * NS_PER_S            # for reading, and for entering after a power cycle
PAGE_TIME = 500 * NS_PER_MS           # added for each page, ten times what a slow adapter needs
LOSS_TIME = 3 * NS_PER_S             # from a failed write to the end of the session
ATTEMPTS = 40               # requests for a page without any answer
REFUSALS = 3                # consecutive refusals of a page
LEAVE_ATTEMPTS = 10
STREAM_FRAMES = 20          # inertial messages that show that the device is not in the mode
ENTRIES = 5                 # times that a device may enter the mode in one session
OK = 0

ServiceFrames = Literal['auto', 'crc32', 'mpeg2', 'crc32_padded', 'mpeg2_padded']


class Variant(NamedTuple):
    """Framing of the requests to enter and to leave."""

    checksum: Checksum
    padded: bool


# That of the maker's own tool first, then that of the document.
VARIANTS = {
    'crc32': Variant('crc32', False), 'mpeg2_padded': Variant('byte', True),
    'mpeg2': Variant('byte', False), 'crc32_padded': Variant('crc32', True)}


class SessionState(Enum):
    """State of a session, with its text for the user."""

    ENTERING = 'asking the device to enter diagnostics mode'
    READING = 'reading'
    LEAVING = 'asking the device to leave diagnostics mode'
    FINISHED = 'finished'


class NvmSession:
    """One session: enter, read pages, leave. Times are in ns of one steady clock."""

    def __init__(self, pages: Sequence[int], now: int, enter_timeout: int = ENTER_TIMEOUT,
                 version: int | None = None, service_frames: ServiceFrames = 'auto') -> None:
        """
        Begin to read pages. Raise ValueError if one is not 0 to 249.

        version is the protocol version of the stream, if known.
        """
        if not pages or not all(0 <= page < PAGES for page in pages):
            raise ValueError(f'NVM pages are 0 to {PAGES - 1}')
        self.state = SessionState.ENTERING
        self.pages: dict[int, bytes] = {}
        self.error = ''
        self._wanted = list(pages)
        self._enter_timeout = enter_timeout
        self._enter_deadline = now + enter_timeout
        self._read_timeout = enter_timeout + READ_TIME + PAGE_TIME * len(self._wanted)
        self._read_deadline = now + self._read_timeout
        self._version = version or VERSIONS[-1]
        self._variants = [VARIANTS[service_frames]] if service_frames != 'auto' \
            else list(VARIANTS.values())
        self._next_variant = cycle(self._variants)
        self._codec = BahrsCodec()
        self._due = now
        self._write_error, self._write_deadline = '', 0
        self._attempts = self._refusals = self._streamed = self._entries = 0

    @property
    def progress(self) -> float:
        """Share of the pages that were read, 0 to 1."""
        return len(self.pages) / len(self._wanted)

    @property
    def description(self) -> str:
        """Text for the user: what the session does, and what to do if it takes long."""
        if self.state is SessionState.ENTERING:
            return 'asking to enter diagnostics mode (if it goes on: switch the device off and on)'
        return str(self.state.value)

    @property
    def finished(self) -> bool:
        """Whether the session has ended."""
        return self.state is SessionState.FINISHED

    def due(self, _now: int) -> int | None:
        """Return when to call send(); None if the session has ended."""
        if self.finished:
            return None
        if self._write_error:
            return self._write_deadline
        if self.state is SessionState.LEAVING:
            return self._due
        return min(self._due, self._read_deadline)

    def send(self, now: int) -> bytes:
        """Return the bytes of the next request; empty if none is due."""
        due = self.due(now)
        if due is None or now < due:
            return b''
        if self._write_error:
            self.abandon(self._write_error)
            return b''
        if now >= self._read_deadline:
            self.cancel('the memory could not be read within '
                        f'{_seconds(self._read_timeout)}: check cable and power supply, and try '
                        'again', now)
        return {SessionState.ENTERING: self._request_to_enter,
                SessionState.READING: self._request_page,
                SessionState.LEAVING: self._request_to_leave}[self.state](now)

    def record_write(self, error: str, now: int) -> None:
        """
        Record the result of a write; error is empty if it succeeded.

        A failed write ends the session LOSS_TIME later. Before that, the reader of a lost link may
        call abandon() with a better reason.
        """
        if error and not self._write_error:
            self._write_error, self._write_deadline = error, now + LOSS_TIME

    def receive(self, message: Message, checksum: str, now: int) -> None:
        """Process a message of the device; checksum is the name of its frame's checksum."""
        if isinstance(message, Inertial):
            self._count_stream(now)
        elif isinstance(message, Acknowledgement):
            self._process_acknowledgement(message, checksum, now)
        elif isinstance(message, NvmPage) and self.state is SessionState.READING:
            self._process_page(message, now)

    def cancel(self, reason: str, now: int) -> None:
        """Stop reading, and leave diagnostics mode."""
        if self.state in (SessionState.ENTERING, SessionState.READING):
            self._leave(now, reason)

    def abandon(self, reason: str) -> None:
        """End at once: the device cannot be reached."""
        if not self.finished:
            self.error = self.error or reason
            self.state = SessionState.FINISHED

    def _request_to_enter(self, now: int) -> bytes:
        if now >= self._enter_deadline:
            self._leave(now, 'the device did not enter diagnostics mode within '
                             f'{_seconds(self._enter_timeout)}; many accept it only within 0.5 s '
                             'of power-on: start again and switch the device off and on')
            return b''
        self._due = now + ENTER_INTERVAL
        variant = next(self._next_variant)
        return self._encode(EnterDiagnostics(), variant)

    def _request_page(self, now: int) -> bytes:
        if self._attempts >= ATTEMPTS:
            self._leave(now, f'page {self._page} was requested {ATTEMPTS} times and never '
                             'arrived')
            return b''
        self._attempts += 1
        self._due = now + ANSWER_TIMEOUT
        return self._encode(NvmReadRequest(self._page), Variant(self._variants[0].checksum, False))

    def _request_to_leave(self, now: int) -> bytes:
        if self._attempts >= LEAVE_ATTEMPTS:
            self.state = SessionState.FINISHED
            return b''
        self._attempts += 1
        self._due = now + ANSWER_TIMEOUT
        return b''.join(self._encode(ExitDiagnostics(), variant) for variant in self._variants)

    def _count_stream(self, now: int) -> None:
        # A few messages of the stream still arrive after the device has entered the mode.
        self._streamed += 1
        if self._streamed < STREAM_FRAMES:
            return
        if self.state is SessionState.READING and self._entries >= ENTRIES:
            self._leave(now, f'the device entered diagnostics mode {ENTRIES} times and did not '
                             'stay in it: check its power supply, and try again')
        elif self.state is SessionState.READING:
            self.state = SessionState.ENTERING
            self._due, self._enter_deadline = now, now + self._enter_timeout
        elif self.state is SessionState.LEAVING and self._attempts:
            self.state = SessionState.FINISHED

    def _process_acknowledgement(self, message: Acknowledgement, checksum: str,
                                 now: int) -> None:
        request = message.acknowledged
        if request == EnterDiagnostics.TYPE and self.state is SessionState.ENTERING:
            self._process_entry(message.status, checksum, now)
        elif request == NvmReadRequest.TYPE and self.state is SessionState.READING:
            self._process_refusal(message.status, now)
        elif request == ExitDiagnostics.TYPE and self.state is SessionState.LEAVING:
            self.state = SessionState.FINISHED

    def _process_entry(self, status: int, checksum: str, now: int) -> None:
        if status != OK:
            self._leave(now, f'the device refuses diagnostics mode (status {status})')
            return
        self._entries += 1
        self._variants = [variant for variant in self._variants
                          if variant.checksum == checksum] or self._variants
        self._next_variant = cycle(self._variants)
        self._change_state(SessionState.READING, now)

    def _process_refusal(self, status: int, now: int) -> None:
        if status == OK:
            return
        self._refusals += 1
        self._due = now
        if self._refusals >= REFUSALS:
            self._leave(now, f'the device cannot read page {self._page} (status {status})')

    def _process_page(self, message: NvmPage, now: int) -> None:
        if message.page != self._page:      # the answer to a repeated request
            return
        self.pages[message.page] = message.data
        if len(self.pages) == len(set(self._wanted)):
            self._leave(now)
        else:
            self._change_state(SessionState.READING, now)

    @property
    def _page(self) -> int:
        return next(page for page in self._wanted if page not in self.pages)

    def _leave(self, now: int, error: str = '') -> None:
        self.error = self.error or error
        self._change_state(SessionState.LEAVING, now)

    def _change_state(self, state: SessionState, now: int) -> None:
        self.state = state
        self._due = now
        self._attempts = self._refusals = self._streamed = 0

    def _encode(self, message: BahrsMessage, variant: Variant) -> bytes:
        return self._codec.encode(message, self._version, variant.checksum, variant.padded)


def _seconds(duration: int) -> str:
    return f'{duration / NS_PER_S:g} s'
