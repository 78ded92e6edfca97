# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a conversion writes to: a bag, or tables."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Protocol

from bahrs_driver.convert.outgoing import Values

# Log time in ns, and what a converter returns.
LoggedValues = tuple[int, tuple[str, Values]]


class TopicWriter(Protocol):
    """Stores values of messages, which come in the order of their times."""

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """
        Prepare all topics, whose types are classes of values.

        A late subscriber gets the last message of those in latched.
        """

    def prepare(self, messages: Iterable[LoggedValues]) -> Iterable[tuple[int, Any]]:
        """Return messages, with their log times, in the form in which they wait for write()."""

    def write(self, messages: Sequence[tuple[int, Any]]) -> None:
        """Store prepared messages in the order of their log times."""
