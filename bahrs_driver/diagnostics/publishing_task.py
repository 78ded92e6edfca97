# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages went out on each topic."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import OK, Verdict
from bahrs_driver.diagnostics.window import Window


class PublishingTask:
    """Shows counters that the node keeps."""

    name = 'Publishing'

    def __init__(self, counts: Mapping[str, int]) -> None:
        """Show the counts, by topic."""
        self._counts = counts
        self._window = Window(lambda: list(counts.values()))

    def judge(self, now: float) -> Verdict:
        """Return whether anything goes out; why nothing does is told by others."""
        _, published = self._window.growth(now)
        if any(published):
            return Verdict(OK, 'Publishing')
        return Verdict(OK, 'Nothing published just now' if any(self._counts.values())
                       else 'Nothing published yet')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the count of each topic."""
        return {topic: str(count) for topic, count in self._counts.items()}
