# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Skip and count the damaged parts of a bag's file.

The libraries that read bags raise many kinds of exceptions for malformed bytes. Only this module
catches them, and makes sentences of them.
"""

from collections import Counter
from collections.abc import Iterator
import contextlib
from pathlib import Path

from bahrs_driver.errors import CaptureError
from bahrs_driver.process.printable import printable

MESSAGE = 'message'             # a kind of part that several modules count


class Damage:
    """Counts the parts of a file that were left out, with the first reason of each kind."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._counts: Counter[str] = Counter()
        self._reasons: dict[str, str] = {}
        self._end = ''

    @contextlib.contextmanager
    def skip_if_damaged(self, part: str) -> Iterator[None]:
        """Count a part, such as 'chunk', as left out if the block that reads it raises."""
        try:
            yield
        except CaptureError:
            raise
        except Exception as error:
            self._counts[part] += 1
            self._reasons.setdefault(part, _reason(error))

    @contextlib.contextmanager
    def stop_if_damaged(self) -> Iterator[None]:
        """Report an early end of the file if the block that reads it raises."""
        try:
            yield
        except CaptureError:
            raise
        except Exception as error:
            self._end = _reason(error)

    def count(self, part: str) -> int:
        """Return how many parts of a kind were left out."""
        return self._counts[part]

    def reason(self, part: str) -> str:
        """Return why the first part of a kind was left out."""
        return self._reasons.get(part, '')

    def sentences(self) -> list[str]:
        """Return a sentence for each kind of part, and one for an early end."""
        file = printable(self._file)
        found = [f'{file}: {count} {part}{"s" if count > 1 else ""} left out as damaged '
                 f'({self._reasons[part]})' for part, count in self._counts.items()]
        if self._end:
            found.append(f'{file} ends early or is damaged: only the part before was read '
                         f'({self._end})')
        return found


def _reason(error: Exception) -> str:
    return printable(str(error) or type(error).__name__, 200)
