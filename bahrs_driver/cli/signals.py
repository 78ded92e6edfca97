# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Which signals end a verb."""

from collections.abc import Iterable
import signal

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def heeded(kinds: Iterable[signal.Signals]) -> list[signal.Signals]:
    """Return the signals but a hang-up that we were told to ignore, as nohup does."""
    return [kind for kind in kinds
            if kind is not signal.SIGHUP or signal.getsignal(kind) is not signal.SIG_IGN]
