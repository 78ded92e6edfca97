# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""The exception of everything that can go wrong with a port."""


class LinkError(Exception):
    """The port cannot be used now. The text says why, and what can be done about it."""

    def __init__(self, reason: str, absent: bool = False) -> None:
        """Set the sentence, and whether the reason is that there is no such port."""
        super().__init__(reason)
        self.absent = absent
