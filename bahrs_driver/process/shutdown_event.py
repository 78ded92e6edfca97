# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
The event that ends a program with threads: a signal, or a call of set().

A threading.Event is not enough. A signal handler runs in the main thread, which may hold the lock
of the event when the handler sets it. And a main thread that waits for a lock is not woken by a
signal that the system delivers to another thread, as can happen after a pause of the process. So
the event is a pipe, which any context can write and poll() waits for.
"""

import contextlib
import os
import select
import signal
import sys
import threading
from typing import NoReturn

EXIT_TIME = 0.5             # s from the event to the end of the process
HANDLED_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def handled_signals() -> list[signal.Signals]:
    """Return the signals that end a program: under nohup, without SIGHUP."""
    return [kind for kind in HANDLED_SIGNALS
            if kind is not signal.SIGHUP or signal.getsignal(kind) is not signal.SIG_IGN]


class ShutdownEvent:
    """An event that stays set. Waiting for it does not depend on a clock that can be set."""

    def __init__(self) -> None:
        self._read_end, self._write_end = os.pipe()
        os.set_blocking(self._write_end, False)

    def set(self) -> None:  # noqa: A003
        """Set the event. Any thread, and any signal handler, may call it."""
        with contextlib.suppress(BlockingIOError):      # the pipe is full of earlier calls
            os.write(self._write_end, b'.')

    def is_set(self) -> bool:
        """Return whether the event is set."""
        return self.wait(0)

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the event is set, for timeout seconds at most; return whether it is."""
        poll = select.poll()        # select() fails on descriptors from 1024 on
        poll.register(self._read_end, select.POLLIN)
        return bool(poll.poll(None if timeout is None else max(0.0, timeout) * 1000))

    def install_signal_handlers(self) -> None:
        """Make the handled signals set the event. Only the main thread may call it."""
        for kind in handled_signals():
            signal.signal(kind, _noop_handler)
        signal.set_wakeup_fd(self._write_end, warn_on_full_buffer=False)

    def limit_exit_time(self, seconds: float = EXIT_TIME) -> None:
        """End the process with status 0 if it still runs some seconds after the event."""
        from bahrs_driver.process.exit_timer import exit_after      # importing ctypes is slow

        def watch() -> None:
            self.wait()
            exit_after(seconds)

        threading.Thread(target=watch, name='exit limit', daemon=True).start()


def end_process(status: int) -> NoReturn:
    """
    End the process now, without the interpreter's clean-up.

    The clean-up takes half a second, destructors of the middleware may wait for the host's clock,
    and a second Ctrl-C would kill the process (see ignore_signals).
    """
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):      # closed, or a broken pipe
            stream.flush()
    os._exit(status)


def ignore_signals() -> None:
    """
    Ignore the handled signals from now on. Only the main thread may call it.

    The interpreter restores the default action of signals while it exits. A second Ctrl-C would
    then kill a process that was about to exit with its own status.
    """
    for kind in HANDLED_SIGNALS:
        signal.signal(kind, signal.SIG_IGN)


def _noop_handler(*_: object) -> None:
    """Do nothing: with a handler in place, Python writes to the wake-up descriptor."""
