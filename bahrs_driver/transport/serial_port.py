# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A serial device, or a pseudo-terminal that takes its place."""

import contextlib
import errno
import fcntl
import os
import stat
import termios
import time

from bahrs_driver.transport.channel import DescriptorChannel
from bahrs_driver.transport.reading import Reading
from bahrs_driver.transport.waker import Waker
import serial

# After a read that another program was faster than: a step longer each time in a row, for the
# port seems to have bytes as long as that program is at it.
BACK_OFF_STEP = 0.001       # s
LONGEST_BACK_OFF = 0.02     # s


class SerialPort(DescriptorChannel):
    """A serial device that is open for this process alone."""

    def __init__(self, path: str, baud_rate: int) -> None:
        """Open it and set it up: 8N1, raw, locked against all who respect locks."""
        # A file, a FIFO or a disk could be harmed by being opened alone.
        if not stat.S_ISCHR(os.stat(path).st_mode):
            raise OSError(errno.ENOTTY, os.strerror(errno.ENOTTY))
        self._serial = serial.Serial(path, baud_rate, exclusive=True)
        super().__init__(self._serial.fileno())
        self.stolen = 0
        self._empty_reads = 0
        # For those who do not look at locks. The kernel lets root in nevertheless.
        with contextlib.suppress(OSError):
            fcntl.ioctl(self._descriptor, termios.TIOCEXCL)

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all there are; None after timeout seconds, or if woken."""
        reading = super().read(timeout, waker)
        if reading:
            self._empty_reads = 0
        return reading

    def close(self) -> None:
        """Close it at once, even if it does not send what was written."""
        for release in (self._unlock, self._discard_output, self._serial.close):
            with contextlib.suppress(OSError, termios.error):
                release()

    def _unlock(self) -> None:
        # A pseudo-terminal remembers it, and we could not open it again ourselves.
        fcntl.ioctl(self._descriptor, termios.TIOCNXCL)

    def _discard_output(self) -> None:
        # Or else closing waits up to 30 s for an adapter that hangs.
        if self._serial.out_waiting:
            self._serial.reset_output_buffer()

    def _found_nothing(self) -> None:
        self._found_end()

    def _found_end(self) -> None:
        """Count bytes that another program took; OSError if the device is gone instead."""
        self._count_waiting()               # fails if it is
        self.stolen += 1
        self._empty_reads += 1
        time.sleep(min(self._empty_reads * BACK_OFF_STEP, LONGEST_BACK_OFF))
