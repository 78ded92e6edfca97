# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Sentences for the user about what happened to a clock, kept until the node logs them."""

from collections import deque

KEPT = 20               # the latest; a conversion takes none before its end


class Notices:
    """Keeps the latest sentences."""

    def __init__(self) -> None:
        self._sentences: deque[str] = deque(maxlen=KEPT)

    def add(self, sentence: str) -> None:
        """Keep a sentence."""
        self._sentences.append(sentence)

    def take(self) -> list[str]:
        """Return what was added since the last call."""
        sentences = list(self._sentences)
        self._sentences.clear()
        return sentences
