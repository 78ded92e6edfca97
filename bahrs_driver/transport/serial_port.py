# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""A serial device or a pseudo-terminal."""

import contextlib
import errno
import fcntl
import os
import stat
import termios
import time

from bahrs_driver.transport.channel import DescriptorChannel, Reading
from bahrs_driver.transport.waker import Waker
import serial

# While another program takes the bytes, poll() announces data that a read does not find. Each such
# read in a row pauses one step longer.
BACK_OFF_STEP = 0.001       # s
LONGEST_BACK_OFF = 0.02     # s


class SerialPort(DescriptorChannel):
    """A serial device, opened for this process alone."""

    def __init__(self, path: str, baud_rate: int) -> None:
        """Open the device with 8N1, in raw mode, and lock it."""
        # Only opening a file, a FIFO or a disk may do harm.
        if not stat.S_ISCHR(os.stat(path).st_mode):
            raise OSError(errno.ENOTTY, os.strerror(errno.ENOTTY))
        self._serial = serial.Serial(path, baud_rate, exclusive=True)
        super().__init__(self._serial.fileno())
        self.stolen = 0
        self._empty_reads = 0
        # Keeps out programs that ignore locks, except those of root.
        with contextlib.suppress(OSError):
            fcntl.ioctl(self._descriptor, termios.TIOCEXCL)

    def read(self, timeout: float, waker: Waker) -> Reading | None:
        """Wait for bytes and return all; None after timeout seconds, or if woken."""
        reading = super().read(timeout, waker)
        if reading:
            self._empty_reads = 0
        return reading

    def close(self) -> None:
        """Close the device at once, and drop output that it has not sent."""
        for release in (self._unlock, self._discard_output, self._serial.close):
            with contextlib.suppress(OSError, termios.error):
                release()

    def _unlock(self) -> None:
        # A pseudo-terminal keeps this mark, which would keep the driver out, too.
        fcntl.ioctl(self._descriptor, termios.TIOCNXCL)

    def _discard_output(self) -> None:
        # Closing would wait up to 30 s for an adapter that hangs.
        if self._serial.out_waiting:
            self._serial.reset_output_buffer()

    def _handle_no_data(self) -> None:
        self._handle_end_of_stream()

    def _handle_end_of_stream(self) -> None:
        """Count a read whose bytes another program took; OSError if the device is gone."""
        fcntl.ioctl(self._descriptor, termios.FIONREAD, bytes(4))   # raises if the device is gone
        self.stolen += 1
        self._empty_reads += 1
        time.sleep(min(self._empty_reads * BACK_OFF_STEP, LONGEST_BACK_OFF))
