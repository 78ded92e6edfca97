# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Install handlers for the signals that end a verb.

A shell that runs a script starts commands in the background with SIGINT ignored, and Python does
not change an ignored signal. A signal sent to a verb should end it, so handlers replace inherited
ones. Only an ignored hang-up stays ignored: nohup relies on it.
"""

from collections.abc import Iterator
import contextlib
import signal

from bahrs_driver.process.shutdown_event import handled_signals, ignore_signals, ShutdownEvent


def interrupt_on_signals() -> None:
    """Raise KeyboardInterrupt for each signal that ends a verb: all clean up alike."""
    for kind in handled_signals():
        signal.signal(kind, signal.default_int_handler)


@contextlib.contextmanager
def signals_deferred() -> Iterator[None]:
    """
    Raise KeyboardInterrupt for a signal only at the end of the block.

    An import can swallow the exception: raised in a callback of the interpreter, it is printed and
    ignored.
    """
    received = []
    for kind in handled_signals():
        signal.signal(kind, lambda number, _: received.append(number))
    try:
        yield
    finally:
        interrupt_on_signals()
    if received:
        raise KeyboardInterrupt


@contextlib.contextmanager
def shutdown_on_signal() -> Iterator[ShutdownEvent]:
    """
    Yield an event that signals set during the block, instead of an interruption.

    Once it is set the program ends, and further signals are ignored.
    """
    event = ShutdownEvent()
    before = {kind: signal.getsignal(kind) for kind in handled_signals()}
    event.install_signal_handlers()
    try:
        yield event
    finally:
        signal.set_wakeup_fd(-1)
        if event.is_set():
            ignore_signals()
        else:
            for kind, handler in before.items():
                signal.signal(kind, handler)
