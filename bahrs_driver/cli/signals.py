# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which signals end a verb.

A shell that runs a script starts commands in the background with SIGINT ignored, and Python
leaves an ignored signal so. Whoever sends one to a verb wants its end, so handlers are installed
whatever was inherited. Only a hang-up that is ignored stays so: nohup does that on purpose.
"""

from collections.abc import Iterable
import signal

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def heeded(kinds: Iterable[signal.Signals]) -> list[signal.Signals]:
    """Return the signals but a hang-up that is ignored."""
    return [kind for kind in kinds
            if kind is not signal.SIGHUP or signal.getsignal(kind) is not signal.SIG_IGN]


def interrupt_on_signals() -> None:
    """Let each signal that ends a verb raise KeyboardInterrupt, so that all tidy up alike."""
    for kind in heeded(ENDING):
        signal.signal(kind, signal.default_int_handler)
