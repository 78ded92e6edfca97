# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Which sample a time message names: the one just sent, or the next.

The real device names the next. The sample that it names has then not been seen when the message
comes, though nothing was lost. A few votes decide, as a lost frame may make one wrong.
"""

from collections import deque
from typing import Literal

Label = Literal['auto', 'next', 'same']
VOTES = 9


class LabelReading:
    """Tells how much further a time message's counter is than the sample that it is about."""

    def __init__(self, label: Label = 'auto', votes: int = VOTES) -> None:
        self._forced = label
        self._votes: deque[int] = deque(maxlen=votes)

    def vote(self, ahead: int) -> None:
        """Take how many samples ahead of the latest one a time message named."""
        if ahead in (0, 1):
            self._votes.append(ahead)

    @property
    def ahead(self) -> int:
        """1 if messages name the next sample, 0 if they name the same."""
        if self._forced != 'auto':
            return int(self._forced == 'next')
        return int(2 * sum(self._votes) >= len(self._votes))

    @property
    def reading(self) -> str:
        """Return the reading in words."""
        if self._forced == 'auto' and not self._votes:
            return 'not seen yet'
        return 'next' if self.ahead else 'same'
