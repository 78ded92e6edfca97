# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Whether a time message names the sample just sent or the next one.

The document can be read either way, and the real device names the next one. That sample has not
arrived yet when the message comes, although no frame was lost: this is how the convention is
detected. A lost frame may cast a wrong vote, so the majority of several votes decides.
"""

from collections import deque
from typing import Literal

Label = Literal['auto', 'next', 'same']
VOTES = 9


class TimeReferenceConvention:
    """Finds how far the counter in a time message is ahead of the sample it gives a time to."""

    def __init__(self, label: Label = 'auto', votes: int = VOTES) -> None:
        """Force a convention, or detect it by the majority of the latest votes."""
        self._label = label
        self._votes: deque[int] = deque(maxlen=votes)

    def vote(self, ahead: int) -> None:
        """Count a vote: how many samples ahead of the latest one a time message named."""
        if ahead in (0, 1):
            self._votes.append(ahead)

    @property
    def ahead(self) -> int:
        """1 if time messages name the next sample, 0 if they name the one just sent."""
        if self._label != 'auto':
            return int(self._label == 'next')
        return int(2 * sum(self._votes) >= len(self._votes))

    @property
    def seen(self) -> bool:
        """Whether the convention is forced, or was voted for."""
        return self._label != 'auto' or bool(self._votes)

    @property
    def label(self) -> str:
        """Return the convention as it appears in diagnostics."""
        if not self.seen:
            return 'not seen yet'
        return 'next' if self.ahead else 'same'
