# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages went out on each topic."""

from collections.abc import Container, Mapping

from bahrs_driver.diagnostics.task import OK, STALE, Status, Template, WARN
from bahrs_driver.process.fault_log import FaultLog

FAULT_LIFETIME = 10.0       # s for which a fault is shown

FAULT = Template(WARN, 'Fault of the driver: {fault}', 'a fault of the driver itself')
NOT_YET = Template(STALE, 'Nothing published yet')
STOPPED = Template(STALE, 'Nothing published just now')
PUBLISHING = Template(OK, 'Publishing')


class PublishingTask:
    """
    Shows the counters of published messages, by topic.

    They are stale after timeout seconds without a change. Latched topics report changes, even the
    loss of all data, and do not count. A fault of the driver is shown for a while.
    """

    name = 'Publishing'
    messages = FAULT, NOT_YET, STOPPED, PUBLISHING

    def __init__(self, counts: Mapping[str, int], timeout: float,
                 latched: Container[str], faults: FaultLog | None = None) -> None:
        self._counts = counts
        self._latched = latched
        self._timeout = timeout
        self._faults = faults or FaultLog(str, str)
        self._latest = 0, 0.0           # total of messages, and the time when it was reached
        self._latest_fault = 0, -FAULT_LIFETIME

    def update(self, now: float) -> None:
        """Check whether messages went out since the last call."""
        published = sum(count for topic, count in self._counts.items()
                        if topic not in self._latched)
        if published != self._latest[0]:
            self._latest = published, now

    def run(self, status: Status) -> Status:
        """Report whether messages go out; other tasks report why none do."""
        status.values_from(self._values)
        faults, now = self._faults, status.now
        if faults.count != self._latest_fault[0]:
            self._latest_fault = faults.count, now
        if now - self._latest_fault[1] < FAULT_LIFETIME:
            return status.summary(FAULT, fault=faults.last)
        self.update(now)
        if not self._latest[0]:
            return status.summary(NOT_YET)
        if now - self._latest[1] > self._timeout:
            return status.summary(STOPPED)
        return status.summary(PUBLISHING)

    def _values(self, _now: float) -> Mapping[str, str]:
        return {**{topic: str(count) for topic, count in self._counts.items()},
                'Faults of the driver': str(self._faults.count),
                'Last fault': self._faults.last or 'none'}
