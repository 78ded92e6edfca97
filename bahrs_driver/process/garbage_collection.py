# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Keep the garbage collector from examining millions of short-lived objects."""

from collections.abc import Iterator
import contextlib
import gc

THRESHOLDS = 100_000, 50, 50        # objects; collections of the younger generation


@contextlib.contextmanager
def rare_collections() -> Iterator[None]:
    """Collect rarely in the block, whose objects hardly ever refer to each other in circles."""
    before = gc.get_threshold()
    gc.set_threshold(*THRESHOLDS)
    try:
        yield
    finally:
        gc.set_threshold(*before)
