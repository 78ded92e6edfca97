# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Print warnings and tables of counts in the same form for all verbs."""

from collections.abc import Iterable
import sys
from typing import TextIO


def warn(verb: str, sentence: str) -> None:
    """Print a sentence on standard error."""
    print(f'bahrs {verb}: {sentence}', file=sys.stderr, flush=True)


def print_counts(counts: Iterable[tuple[str, int]], file: TextIO | None = None,
                 width: int = 22) -> None:
    """Print one line per count, with the names in a column of this width."""
    for name, count in counts:
        print(f'{name:<{width}}{count:>12,}', file=file)
