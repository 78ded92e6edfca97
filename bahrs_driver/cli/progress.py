# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Show a progress bar on standard error, if that is a terminal."""

from collections.abc import Iterator
import contextlib

from rich.console import Console
from rich.progress import Progress


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress]:
    """Show a bar on a terminal; write nothing into a file or a pipe."""
    console = Console(stderr=True)
    progress = Progress(console=console, transient=True)
    with contextlib.ExitStack() as stack:
        # Not with disable=True: rich 13 prints an empty line after a disabled bar.
        if console.is_terminal:
            stack.enter_context(progress)
        yield progress
