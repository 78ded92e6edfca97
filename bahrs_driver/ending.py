# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
What ends a program with threads: a signal, or somebody who says so.

An Event will not do. Its lock may be held by the main thread just when a signal's handler, which
runs in that thread, sets it; and a signal that the system hands to another thread, as it may after
a pause of the process, does not wake a main thread that waits for a lock.
"""

import contextlib
import os
import select
import signal


class Ending:
    """Something to wait for. Any thread may tell that it has come, which then stays so."""

    def __init__(self) -> None:
        """Begin before it."""
        self._read_end, self._write_end = os.pipe()
        os.set_blocking(self._write_end, False)

    def tell(self) -> None:
        """Let whoever waits go on."""
        with contextlib.suppress(BlockingIOError):      # was told very often
            os.write(self._write_end, b'.')

    def wait(self, timeout: float | None = None) -> bool:
        """Return whether it has come, or does so within a time in seconds."""
        return bool(select.select([self._read_end], [], [], timeout)[0])

    def listen_to(self, *signals: int) -> None:
        """Take signals for it from now on. To be called in the main thread."""
        for number in signals:
            signal.signal(number, _go_on)
        signal.set_wakeup_fd(self._write_end, warn_on_full_buffer=False)


def _go_on(*_: object) -> None:
    """Do nothing: that there is a handler makes Python write to the wake-up descriptor."""
