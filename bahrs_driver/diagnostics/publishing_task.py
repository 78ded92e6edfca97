# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages went out on each topic."""

from collections.abc import Container, Mapping

from bahrs_driver.diagnostics.task import OK, STALE, Verdict, WARN
from bahrs_driver.process.fault_log import FaultLog

FAULT_LIFETIME = 10.0       # s that a fault is shown


class PublishingTask:
    """Shows counters that the node keeps."""

    name = 'Publishing'

    def __init__(self, counts: Mapping[str, int], timeout: float,
                 latched: Container[str], faults: FaultLog | None = None) -> None:
        """
        Show the counts, by topic; they are stale after timeout seconds without a change.

        Latched topics report changes, also the loss of all data, and do not count. A
        fault of the driver is shown for a while.
        """
        self._counts = counts
        self._latched = latched
        self._timeout = timeout
        self._faults = faults or FaultLog(str, str)
        self._latest = 0, 0.0           # messages in all, and when they were counted first
        self._latest_fault = 0, -FAULT_LIFETIME

    def update(self, now: float) -> None:
        """Look whether messages went out since the last call."""
        published = sum(count for topic, count in self._counts.items()
                        if topic not in self._latched)
        if published != self._latest[0]:
            self._latest = published, now

    def judge(self, now: float) -> Verdict:
        """Return whether messages go out; other tasks say why none do."""
        faults = self._faults
        if faults.count != self._latest_fault[0]:
            self._latest_fault = faults.count, now
        if now - self._latest_fault[1] < FAULT_LIFETIME:
            return Verdict(WARN, f'Fault of the driver: {faults.last}')
        self.update(now)
        if not self._latest[0]:
            return Verdict(STALE, 'Nothing published yet')
        if now - self._latest[1] > self._timeout:
            return Verdict(STALE, 'Nothing published just now')
        return Verdict(OK, 'Publishing')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the count of each topic, and of faults."""
        return {**{topic: str(count) for topic, count in self._counts.items()},
                'Faults of the driver': str(self._faults.count),
                'Last fault': self._faults.last or 'none'}
