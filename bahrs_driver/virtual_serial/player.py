# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Play a recorded stream on a port while a reader has the port open."""

from collections.abc import Callable, Iterable
import time

from bahrs_driver.virtual_serial.pacing import Piece
from bahrs_driver.virtual_serial.pty_port import PtyPort


class Player:
    """
    Writes pieces when they are due, and pauses while no reader has the port open.

    Pieces written without a reader would be lost.
    """

    def __init__(self, port: PtyPort, rate: float, settle: float, reopen_timeout: float | None,
                 on_close: Callable[[str], None]) -> None:
        """
        Play on a port; no piece is played before play() is called.

        rate is the speed relative to the recording, settle the time in seconds that a reader gets
        after opening the port, reopen_timeout the longest time to wait for another reader.
        on_close is called with a sentence for the user when the reader closes the port.
        """
        self.played = 0                 # bytes
        self._port, self._rate, self._settle = port, rate, settle
        self._reopen_timeout, self._on_close = reopen_timeout, on_close

    def play(self, pieces: Iterable[Piece]) -> bool:
        """Play to the end; False if the reader closes the port and no reader opens it again."""
        start = None
        for due, data in pieces:
            if start is None:           # reading and decoding the first piece is not a delay
                start = time.monotonic() - due / self._rate
            ahead = start + due / self._rate - time.monotonic()
            if ahead > 0:
                time.sleep(ahead)
            while not self._write(data):
                closed = time.monotonic()
                if not self._wait_for_reader(due):
                    return False
                start += time.monotonic() - closed
        return True

    def _write(self, data: bytes) -> bool:
        """Write a piece; return False if there is no reader for it."""
        if not data:            # the end of the stream needs no reader
            return True
        if not self._port.is_open:
            return False
        self._port.write(data)
        self.played += len(data)
        return True

    def _wait_for_reader(self, due: float) -> bool:
        limit = '' if self._reopen_timeout is None else f' for {self._reopen_timeout:g} s'
        self._on_close(f'the reader has closed the port {due:.1f} s after the start: waiting'
                       f'{limit} until a program opens it again')
        if not self._port.wait_until_open(self._reopen_timeout):
            return False
        time.sleep(self._settle)
        return True
