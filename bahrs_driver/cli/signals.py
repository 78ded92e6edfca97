# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which signals end a verb.

A shell that runs a script starts commands in the background with SIGINT ignored, and Python
leaves an ignored signal so. A signal sent to a verb is meant to end it, so handlers are installed
whatever was inherited. Only a hang-up that is ignored stays so: nohup does that on purpose.
"""

from collections.abc import Iterator
import contextlib
import signal

from bahrs_driver.process.shutdown_event import handled_signals, ignore_signals, ShutdownEvent


def interrupt_on_signals() -> None:
    """Let each signal that ends a verb raise KeyboardInterrupt, so that all tidy up alike."""
    for kind in handled_signals():
        signal.signal(kind, signal.default_int_handler)


@contextlib.contextmanager
def shutdown_on_signal() -> Iterator[ShutdownEvent]:
    """
    Let signals set an event for the length of a block, so that they interrupt nothing.

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
