# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Notices of a clock for the user, kept until the node logs them."""

from collections import deque

KEPT = 20               # the latest; a conversion takes none before its end


class Notices:
    """Keeps the latest sentences."""

    def __init__(self) -> None:
        self._sentences: deque[str] = deque(maxlen=KEPT)

    def add(self, sentence: str) -> None:
        """Add a sentence."""
        self._sentences.append(sentence)

    def take(self) -> list[str]:
        """Return the sentences added since the last call."""
        sentences = list(self._sentences)
        self._sentences.clear()
        return sentences
