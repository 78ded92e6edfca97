# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The command `bahrs` without a process of its own, for what needs none."""

import contextlib
import io
import signal

from bahrs_driver.cli.main import main


def run_bahrs(*words: object) -> tuple[int, str, str]:
    """Run a verb in this process; return its exit status, standard output and error."""
    handlers = {kind: signal.getsignal(kind) for kind in signal.valid_signals()}
    out, error = io.StringIO(newline=''), io.StringIO()
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            status = main([str(word) for word in words])
    except SystemExit as stop:
        status = int(stop.code or 0)
    finally:
        for kind, handler in handlers.items():
            if handler is not None and signal.getsignal(kind) is not handler:
                signal.signal(kind, handler)
    return status, out.getvalue(), error.getvalue()
