# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""What a converter returns, and which topics it converts for."""

from collections.abc import Container, Iterator
from typing import Any

Values = tuple[Any, ...]                        # of convert.values
Outgoing = Iterator[tuple[str, Values]]         # topics with their values


class AllTopics(Container[str]):
    """Contains every topic."""

    def __contains__(self, _topic: object) -> bool:
        return True


ALL_TOPICS = AllTopics()
