# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a conversion writes to: a bag, or tables."""

from collections.abc import Mapping
from typing import Protocol


class TopicWriter(Protocol):
    """Stores messages, which come in the order of their times."""

    def begin(self, topics: Mapping[str, type], latched: set[str]) -> None:
        """Prepare all topics; a late subscriber gets the last message of those in latched."""

    def write(self, topic: str, time_ns: int, message: object) -> None:
        """Store a message with its log time."""
