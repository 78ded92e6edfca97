# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The diagnostics mode of a BAHRS, in which the device answers instead of streaming. No I/O.

    0xF0 enter         -> 0xFF acknowledgement of 0xF0
    0xF2 read page     -> 0xF3 the page, or 0xFF with status 0xFF
    0xF1 exit          -> 0xFF acknowledgement of 0xF1, and the stream goes on

Without a request for its time-out, the device leaves the mode by itself. Outside the mode it
ignores 0xF1 and 0xF2, and it always ignores frames of another variant than its own.
"""

from dataclasses import dataclass, field
import math
from typing import Literal

from bahrs_driver.emulator.bahrs.nvm_image import example_image, page
from bahrs_driver.protocol.bahrs.frames import BahrsCodec, BahrsFormat, frame_size
from bahrs_driver.protocol.bahrs.messages import (
    Acknowledgement,
    BahrsMessage,
    EnterDiagnostics,
    ExitDiagnostics,
    NvmPage,
    NvmReadRequest,
)
from bahrs_driver.protocol.bahrs.nvm_session import PAGES
from bahrs_driver.protocol.framing import Frame, Framer

INACTIVITY_TIMEOUT = 5.0                # s without a request, by the document
POWER_ON_WINDOW = 0.5           # s
OK, FAILED = 0x00, 0xFF

ServiceChecksum = Literal['crc32', 'byte']
_BARE_SIZE = frame_size(0, padded=False)


@dataclass(frozen=True)
class ServiceBehavior:
    """Properties of a device in diagnostics mode."""

    checksum: ServiceChecksum = 'crc32'     # as the maker's tool, or byte by the document
    padded: bool = False                    # 0xF0 and 0xF1, by the document
    window: Literal['always', 'power-on'] = 'always'
    error_pages: frozenset[int] = frozenset()
    image: bytes = field(default_factory=example_image)
    timeout: float = INACTIVITY_TIMEOUT


class DiagnosticsMode:
    """Answers requests. All times are true times in seconds."""

    def __init__(self, behavior: ServiceBehavior) -> None:
        self._behavior = behavior
        self._codec = BahrsCodec()
        self.restart(0.0)

    def restart(self, time: float) -> None:
        """Restart as after power-on."""
        self._framer = Framer(BahrsFormat())
        self._power_on = time
        self._last_request = -math.inf      # its time; -inf outside the mode

    def active(self, time: float) -> bool:
        """Return whether the device is in diagnostics mode."""
        return time < self._last_request + self._behavior.timeout

    def receive(self, data: bytes, time: float) -> list[BahrsMessage]:
        """Receive bytes from the host and return the answers."""
        requests = [self._codec.decode(frame) for frame in self._framer.feed(data)
                    if self._is_own_variant(frame)]
        answers = [self._answer(request, time) for request in requests]
        return [answer for answer in answers if answer]

    def _is_own_variant(self, frame: Frame) -> bool:
        kind = frame.data[4]
        if kind in (EnterDiagnostics.TYPE, ExitDiagnostics.TYPE):
            if (len(frame.data) > _BARE_SIZE) != self._behavior.padded:
                return False
        return frame.checksum == self._behavior.checksum

    def _answer(self, request: BahrsMessage, time: float) -> BahrsMessage | None:
        if isinstance(request, EnterDiagnostics):
            return self._enter(time)
        if not self.active(time):
            return None
        if isinstance(request, NvmReadRequest):
            self._last_request = time
            return self._read(request.page)
        if isinstance(request, ExitDiagnostics):
            self._last_request = -math.inf
            return Acknowledgement(ExitDiagnostics.TYPE, OK)
        return None

    def _enter(self, time: float) -> BahrsMessage | None:
        in_window = self._behavior.window == 'always' or time <= self._power_on + POWER_ON_WINDOW
        if not in_window and not self.active(time):
            return None
        self._last_request = time
        return Acknowledgement(EnterDiagnostics.TYPE, OK)

    def _read(self, number: int) -> BahrsMessage:
        if number >= PAGES or number in self._behavior.error_pages:
            return Acknowledgement(NvmReadRequest.TYPE, FAILED)
        return NvmPage(number, page(self._behavior.image, number))
