# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
End a process at a time limit, even if no Python code can run.

Fast DDS waits for its shared memory until a time of the host's clock. If that clock is set back by
an hour, destroying a node takes an hour. rclpy holds the interpreter lock meanwhile, so neither a
thread nor a signal handler in Python can end the process. A POSIX timer on the monotonic clock
can: it calls _exit() in a thread of the C library.
"""

import ctypes
import time

from bahrs_driver.units import NS_PER_S

_SIGEV_THREAD = 2


class _SigEvent(ctypes.Structure):
    """struct sigevent of Linux: 64 bytes."""

    _fields_ = [('value', ctypes.c_void_p), ('signal', ctypes.c_int), ('notify', ctypes.c_int),
                ('function', ctypes.c_void_p), ('attributes', ctypes.c_void_p),
                ('padding', ctypes.c_char * 32)]


class _TimerSpec(ctypes.Structure):
    """struct itimerspec: period and first expiry, each in seconds and nanoseconds."""

    _fields_ = [(name, ctypes.c_long) for name in (
        'period_sec', 'period_nsec', 'first_sec', 'first_nsec')]


def exit_after(seconds: float, status: int = 0) -> None:
    """End the process with an exit status after a time in seconds, even if Python is blocked."""
    libc = ctypes.CDLL(None, use_errno=True)
    timer = ctypes.c_void_p()
    event = _SigEvent(value=status, notify=_SIGEV_THREAD,
                      function=ctypes.cast(libc['_exit'], ctypes.c_void_p))
    # An expiry of 0 would disarm the timer.
    expiry = _TimerSpec(0, 0, *divmod(max(1, round(seconds * NS_PER_S)), NS_PER_S))
    if libc.timer_create(time.CLOCK_MONOTONIC, ctypes.byref(event), ctypes.byref(timer)) or \
            libc.timer_settime(timer, 0, ctypes.byref(expiry), None):
        raise OSError(ctypes.get_errno(), 'cannot start the exit timer')
