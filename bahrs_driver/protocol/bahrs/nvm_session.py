# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Reading the non-volatile memory of a BAHRS: a diagnostics session as a state machine.

The session is told what came and what time it is, and tells what to send; it reads no clock and
writes no port. It reads only: there is no message that would write to the memory.

    ENTERING   asks to enter, again and again, until the device agrees or the time is up
    READING    asks for one page after the other, again where an answer is late or damaged
    LEAVING    asks to leave, until the device agrees, streams again, or is left to itself
    FINISHED   everything is in `pages`, or `error` says why it is not

Known firmware agrees to enter only within half a second of power-on, so entering goes on for
long, and the user is told to switch the device off and on. Nobody knows beforehand which of the
service frames' variants a device understands (padding and CRC, see bahrs_frames), so entering goes
through all of them; the CRC of the answer tells which it was. A device that streams in the midst
of reading has left on its own or was restarted, and is asked to enter again, a few times.
A device that does not answer to leaving leaves on its own five seconds after the last request.
Whatever the device does, a session ends: no later than `time_limit` seconds after its begin.
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

PAGES = 250
PAGE_SIZE = 32

ENTER_INTERVAL = 0.05       # s from one request to enter to the next
ANSWER_TIMEOUT = 0.1        # s, twice what a page, a slow device and an adapter's timer need
ATTEMPTS = 40               # requests for a page without any answer before giving up
REFUSALS = 3                # answers in a row that a page cannot be read before believing it
LEAVE_ATTEMPTS = 10
STREAM_FRAMES = 20          # inertial messages that show that the device is not in the mode
ENTRIES = 5                 # times that a device may agree to enter before giving up
READ_TIME = 10.0            # s for reading, and for entering again after a power-cycle
PAGE_TIME = 0.5             # s more for each page, ten times what a slow adapter takes
OK = 0

ServiceFrames = Literal['auto', 'crc32', 'mpeg2', 'crc32_padded', 'mpeg2_padded']


class Variant(NamedTuple):
    """How requests to enter and to leave are framed."""

    checksum: Checksum
    padded: bool


# The maker's own tool first, then the document.
VARIANTS = {
    'crc32': Variant('crc32', False), 'mpeg2_padded': Variant('byte', True),
    'mpeg2': Variant('byte', False), 'crc32_padded': Variant('crc32', True)}


class State(Enum):
    """Where a session is, in words."""

    ENTERING = 'asking the device to enter diagnostics mode'
    READING = 'reading'
    LEAVING = 'asking the device to leave diagnostics mode'
    FINISHED = 'finished'


class NvmSession:
    """One session: enter, read some pages, leave. Times are in seconds, of any one clock."""

    def __init__(self, pages: Sequence[int], now: float, enter_timeout: float = 30.0,
                 version: int | None = None, service_frames: ServiceFrames = 'auto') -> None:
        """
        Begin to read pages (0 to 249; ValueError).

        The version is the protocol version that the device streams in, if known.
        """
        if not pages or not all(0 <= page < PAGES for page in pages):
            raise ValueError(f'NVM pages are 0 to {PAGES - 1}')
        self.state = State.ENTERING
        self.pages: dict[int, bytes] = {}
        self.error = ''
        self._wanted = list(pages)
        self._enter_timeout = enter_timeout
        self._enter_deadline = now + enter_timeout
        self._read_limit = enter_timeout + READ_TIME + PAGE_TIME * len(self._wanted)
        self._read_deadline = now + self._read_limit
        self._version = version or VERSIONS[-1]
        self._variants = [VARIANTS[service_frames]] if service_frames != 'auto' \
            else list(VARIANTS.values())
        self._next_variant = cycle(self._variants)
        self._codec = BahrsCodec()
        self._due = now
        self._attempts = self._refusals = self._streamed = self._entries = 0

    @property
    def time_limit(self) -> float:
        """Seconds from the begin of the session to its end, at most."""
        return self._read_limit + LEAVE_ATTEMPTS * ANSWER_TIMEOUT

    @property
    def progress(self) -> float:
        """Share of the pages that were read, 0 to 1."""
        return len(self.pages) / len(self._wanted)

    @property
    def description(self) -> str:
        """What the session does, and what the user can do about it."""
        if self.state is State.ENTERING:
            return 'asking to enter diagnostics mode (if it goes on: switch the device off and on)'
        return str(self.state.value)

    @property
    def due(self) -> float:
        """When send() has something to do next."""
        return self._due

    def send(self, now: float) -> bytes:
        """Return what is to be sent now; nothing if it is not yet time."""
        if now < self._due:
            return b''
        if now >= self._read_deadline:
            self.cancel(f'the memory could not be read within {self._read_limit:g} s: check cable '
                        'and power supply, and try again', now)
        if self.state is State.ENTERING:
            return self._ask_to_enter(now)
        if self.state is State.READING:
            return self._ask_for_page(now)
        if self.state is State.LEAVING:
            return self._ask_to_leave(now)
        return b''

    def receive(self, message: BahrsMessage, checksum: str, now: float) -> None:
        """Take a message of the device, and the checksum that its frame carried."""
        if isinstance(message, Inertial):
            self._see_stream(now)
        elif isinstance(message, Acknowledgement):
            self._see_acknowledgement(message, checksum, now)
        elif isinstance(message, NvmPage) and self.state is State.READING:
            self._see_page(message, now)

    def cancel(self, reason: str, now: float) -> None:
        """Read no more, and leave."""
        if self.state in (State.ENTERING, State.READING):
            self._leave(now, reason)

    def abandon(self, reason: str) -> None:
        """End at once: there is nobody left to talk to."""
        self.error = self.error or reason
        self.state = State.FINISHED

    def _ask_to_enter(self, now: float) -> bytes:
        if now >= self._enter_deadline:
            self._leave(now, 'the device did not enter diagnostics mode within '
                             f'{self._enter_timeout:g} s; many accept it only within 0.5 s of '
                             'power-on: start again and switch the device off and on')
            return b''
        self._due = now + ENTER_INTERVAL
        variant = next(self._next_variant)
        return self._encode(EnterDiagnostics(), variant)

    def _ask_for_page(self, now: float) -> bytes:
        if self._attempts >= ATTEMPTS:
            self._leave(now, f'page {self._page} was asked for {ATTEMPTS} times and never came')
            return b''
        self._attempts += 1
        self._due = now + ANSWER_TIMEOUT
        return self._encode(NvmReadRequest(self._page), Variant(self._variants[0].checksum, False))

    def _ask_to_leave(self, now: float) -> bytes:
        if self._attempts >= LEAVE_ATTEMPTS:
            self.state = State.FINISHED
            return b''
        self._attempts += 1
        self._due = now + ANSWER_TIMEOUT
        return b''.join(self._encode(ExitDiagnostics(), variant) for variant in self._variants)

    def _see_stream(self, now: float) -> None:
        # Some of it is still under way when the device has agreed to enter.
        self._streamed += 1
        if self._streamed < STREAM_FRAMES:
            return
        if self.state is State.READING and self._entries >= ENTRIES:
            self._leave(now, f'the device agreed {ENTRIES} times to diagnostics mode and did not '
                             'stay in it: check its power supply, and try again')
        elif self.state is State.READING:
            self.state = State.ENTERING
            self._due, self._enter_deadline = now, now + self._enter_timeout
        elif self.state is State.LEAVING and self._attempts:
            self.state = State.FINISHED

    def _see_acknowledgement(self, message: Acknowledgement, checksum: str, now: float) -> None:
        asked = message.acknowledged
        if asked == EnterDiagnostics.TYPE and self.state is State.ENTERING:
            self._see_entered(message.status, checksum, now)
        elif asked == NvmReadRequest.TYPE and self.state is State.READING:
            self._see_refusal(message.status, now)
        elif asked == ExitDiagnostics.TYPE and self.state is State.LEAVING:
            self.state = State.FINISHED

    def _see_entered(self, status: int, checksum: str, now: float) -> None:
        if status != OK:
            self._leave(now, f'the device refuses diagnostics mode (status {status})')
            return
        self._entries += 1
        self._variants = [v for v in self._variants if v.checksum == checksum] or self._variants
        self._next_variant = cycle(self._variants)
        self._go(State.READING, now)

    def _see_refusal(self, status: int, now: float) -> None:
        if status == OK:
            return
        self._refusals += 1
        self._due = now
        if self._refusals >= REFUSALS:
            self._leave(now, f'the device cannot read page {self._page} (status {status})')

    def _see_page(self, message: NvmPage, now: float) -> None:
        if message.page != self._page:      # the answer to a request that was made again
            return
        self.pages[message.page] = message.data
        if len(self.pages) == len(set(self._wanted)):
            self._leave(now)
        else:
            self._go(State.READING, now)

    @property
    def _page(self) -> int:
        return next(page for page in self._wanted if page not in self.pages)

    def _leave(self, now: float, error: str = '') -> None:
        self.error = self.error or error
        self._go(State.LEAVING, now)

    def _go(self, state: State, now: float) -> None:
        self.state = state
        self._due = now
        self._attempts = self._refusals = self._streamed = 0

    def _encode(self, message: BahrsMessage, variant: Variant) -> bytes:
        return self._codec.encode(message, self._version, variant.checksum, variant.padded)
