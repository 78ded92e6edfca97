# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Wake a thread that waits in poll()."""

import contextlib
import os
import weakref


class Waker:
    """A descriptor that is readable from wake() to clear(). Any thread may use it."""

    def __init__(self) -> None:
        self._read_end, self._write_end = os.pipe()
        for descriptor in (self._read_end, self._write_end):
            os.set_blocking(descriptor, False)
            weakref.finalize(self, os.close, descriptor)

    def fileno(self) -> int:
        """Return the descriptor to wait for."""
        return self._read_end

    def wake(self) -> None:
        """Wake the thread that waits, now or later."""
        with contextlib.suppress(BlockingIOError):      # the pipe is full of wake-ups
            os.write(self._write_end, b'.')

    def clear(self) -> bool:
        """Reset the descriptor; return whether it was readable."""
        try:
            return bool(os.read(self._read_end, 65536))
        except BlockingIOError:
            return False
