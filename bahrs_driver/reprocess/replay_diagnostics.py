# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""
Regenerate the diagnostics of a capture at the times of its reads.

The task *Link* is missing, because a capture has the bytes of a port and not its state.
"""

from collections.abc import Iterator, Sequence

from bahrs_driver.bag.capture import Chunk
from bahrs_driver.bag.log_clock import LogInstant
from bahrs_driver.clock import Clock
from bahrs_driver.convert.values import DiagnosticArray
from bahrs_driver.devices.parts import Parts
from bahrs_driver.devices.registry import recognize
from bahrs_driver.devices.settings import CommonSettings
from bahrs_driver.devices.spec import AnyDevice
from bahrs_driver.diagnostics.framing_task import FramingTask
from bahrs_driver.diagnostics.publishing_task import PublishingCounters, PublishingTask
from bahrs_driver.diagnostics.time_task import TimeTask
from bahrs_driver.diagnostics.updater import Updater
from bahrs_driver.pipeline import Event, Notice, PipelineCounters, Stamped
from bahrs_driver.units import NS_PER_S

TOPIC = '/diagnostics'
PERIOD = NS_PER_S
LONGEST_SILENCE = 60 * NS_PER_S         # with a report every PERIOD


class ReplayDiagnostics:
    """Runs diagnostic tasks over a capture. Times are log times in ns, stamps are ROS time."""

    def __init__(self, spec: AnyDevice, parts: Parts, clock: Clock,
                 counters: PipelineCounters, settings: CommonSettings) -> None:
        self.counters = PublishingCounters.of_topics(spec.topics())
        self._health = parts.health
        self._time_task = TimeTask(clock, parts.health.stale)
        self._now = self._due = self._offset = 0
        self._connection_id: int | None = None
        self._publishing_task = PublishingTask(self.counters, parts.silence_timeout)
        self._updater = Updater(
            [FramingTask(counters, settings.baud_rate, spec.name, parts.protocol, recognize,
                         settings.diagnostics.damaged_share),
             self._time_task, *parts.health.tasks, self._publishing_task],
            'bahrs_driver', spec.name, lambda: self._now / NS_PER_S)

    def reports_before(self, now: int) -> Iterator[tuple[int, DiagnosticArray]]:
        """Yield the reports that were due before a time, each with its own time."""
        if self._connection_id is None:
            self._due = now
        end = min(now, self._due + LONGEST_SILENCE)
        while self._due < end:
            yield self._report(self._due)
        self._due = max(self._due, now)

    def update(self, chunk: Chunk, read: LogInstant,
               events: Sequence[Event]) -> Iterator[tuple[int, DiagnosticArray]]:
        """Update the tasks with a chunk and its events; yield a report if one is due."""
        self._now, self._offset = read.log_ns, read.offset
        seconds = self._now / NS_PER_S
        if chunk.connection_id != self._connection_id:
            self._connection_id = chunk.connection_id
            self._health.restart()
        self._time_task.update(seconds)
        for event in events:
            if isinstance(event, Notice):
                self._time_task.notice(event.text, seconds)
            elif isinstance(event, Stamped):
                self._health.observe(event.message, seconds)
        self._publishing_task.update(seconds)
        if self._now >= self._due or self._updater.change_due():
            yield self._report(self._now)

    def _report(self, now: int) -> tuple[int, DiagnosticArray]:
        self._now, self._due = now, now + PERIOD
        return now, DiagnosticArray(now + self._offset, '', self._updater.statuses())
