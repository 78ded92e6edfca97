# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Waiting for a condition instead of for a time."""

from collections.abc import Callable
import time

# Long enough for a machine that does much else: only what fails ever waits so long.
PATIENCE = 60.0                 # s


def wait_for(condition: Callable[[], object], timeout: float = PATIENCE) -> bool:
    """Wait until a condition holds; return False if it did not in time (seconds)."""
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True
