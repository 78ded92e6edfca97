# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Publishing*: how many messages were published on each topic."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from bahrs_driver.diagnostics.task import OK, STALE, Status, Template, WARN
from bahrs_driver.process.fault_log import FaultLog

FAULT_LIFETIME = 10.0       # s for which a fault is shown

FAULT = Template(WARN, 'Fault of the driver: {fault}', 'a fault of the driver itself')
NOT_YET = Template(STALE, 'Nothing published yet')
STOPPED = Template(STALE, 'Nothing published just now')
NO_SUBSCRIBER = Template(OK, 'No topic has a subscriber')
PUBLISHING = Template(OK, 'Publishing')


@dataclass
class PublishingCounters:
    """What was published so far. Any thread may read it."""

    messages: dict[str, int]            # by topic
    in_use: Collection[str] = ()        # topics with subscribers; no other is published
    converted: int = 0                  # messages of the device, published or not

    @classmethod
    def of_topics(cls, topics: Collection[str]) -> 'PublishingCounters':
        """Return counters for topics that are all in use."""
        return cls(dict.fromkeys(topics, 0), tuple(topics))


class PublishingTask:
    """
    Watches the counters of published messages, by topic.

    The task is stale after timeout seconds in which no message of the device was converted. A
    fault of the driver is shown for a while.
    """

    name = 'Publishing'
    messages = FAULT, NOT_YET, STOPPED, NO_SUBSCRIBER, PUBLISHING

    def __init__(self, counters: PublishingCounters, timeout: float,
                 faults: FaultLog | None = None) -> None:
        self._counters = counters
        self._timeout = timeout
        self._faults = faults or FaultLog(str, str)
        self._converted, self._converted_at = 0, 0.0
        self._fault_count, self._fault_at = 0, -FAULT_LIFETIME

    def update(self, now: float) -> None:
        """Check whether messages were converted since the last call."""
        converted = self._counters.converted
        if converted != self._converted:
            self._converted, self._converted_at = converted, now

    def run(self, status: Status) -> Status:
        """Report whether messages are published; other tasks report the reason if not."""
        status.values_from(self._values)
        faults, now = self._faults, status.now
        if faults.count != self._fault_count:
            self._fault_count, self._fault_at = faults.count, now
        if now - self._fault_at < FAULT_LIFETIME:
            return status.summary(FAULT, fault=faults.last)
        self.update(now)
        if not self._converted:
            return status.summary(NOT_YET)
        if now - self._converted_at > self._timeout:
            return status.summary(STOPPED)
        return status.summary(PUBLISHING if self._counters.in_use else NO_SUBSCRIBER)

    def _values(self, _now: float) -> Mapping[str, str]:
        counters = self._counters
        unused = [topic for topic in counters.messages if topic not in counters.in_use]
        return {**{topic: str(count) for topic, count in counters.messages.items()},
                'Without subscriber': ', '.join(unused) or 'none',
                'Faults of the driver': str(self._faults.count),
                'Last fault': self._faults.last or 'none'}
