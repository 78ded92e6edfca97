# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages were published on each topic."""

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
    Watches the counters of published messages, by topic.

    They are stale after timeout seconds without a change. Latched topics do not count, because
    they also report the loss of all data. A fault of the driver is shown for FAULT_LIFETIME.
    """

    name = 'Publishing'
    messages = FAULT, NOT_YET, STOPPED, PUBLISHING

    def __init__(self, counts: Mapping[str, int], timeout: float,
                 latched: Container[str], faults: FaultLog | None = None) -> None:
        self._counts = counts
        self._latched = latched
        self._timeout = timeout
        self._faults = faults or FaultLog(str, str)
        self._published, self._published_at = 0, 0.0
        self._fault_count, self._fault_at = 0, -FAULT_LIFETIME

    def update(self, now: float) -> None:
        """Check whether messages were published since the last call."""
        published = sum(count for topic, count in self._counts.items()
                        if topic not in self._latched)
        if published != self._published:
            self._published, self._published_at = published, now

    def run(self, status: Status) -> Status:
        """Report whether messages are published; other tasks report the reason if not."""
        status.values_from(self._values)
        faults, now = self._faults, status.now
        if faults.count != self._fault_count:
            self._fault_count, self._fault_at = faults.count, now
        if now - self._fault_at < FAULT_LIFETIME:
            return status.summary(FAULT, fault=faults.last)
        self.update(now)
        if not self._published:
            return status.summary(NOT_YET)
        if now - self._published_at > self._timeout:
            return status.summary(STOPPED)
        return status.summary(PUBLISHING)

    def _values(self, _now: float) -> Mapping[str, str]:
        return {**{topic: str(count) for topic, count in self._counts.items()},
                'Faults of the driver': str(self._faults.count),
                'Last fault': self._faults.last or 'none'}
