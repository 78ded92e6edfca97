# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages went out on each topic."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import OK, STALE, Verdict


class PublishingTask:
    """Shows counters that the node keeps."""

    name = 'Publishing'

    def __init__(self, counts: Mapping[str, int], timeout: float) -> None:
        """Show the counts, by topic; they are stale after timeout seconds without a change."""
        self._counts = counts
        self._timeout = timeout
        self._latest = 0, 0.0           # messages in all, and when there were fewer

    def judge(self, now: float) -> Verdict:
        """Return whether messages go out; other tasks say why none do."""
        published = sum(self._counts.values())
        if published != self._latest[0]:
            self._latest = published, now
        if not published:
            return Verdict(STALE, 'Nothing published yet')
        if now - self._latest[1] > self._timeout:
            return Verdict(STALE, 'Nothing published just now')
        return Verdict(OK, 'Publishing')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the count of each topic."""
        return {topic: str(count) for topic, count in self._counts.items()}
