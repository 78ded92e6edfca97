# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics of a Titan-M and its answers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from bahrs_driver.diagnostics.losses import RequestLosses
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.task import (
    NO_DATA, OK, STALE, Staleness, Task, Verdict, WARN,
)
from bahrs_driver.protocol.titan_m.byte_order import PayloadReader
from bahrs_driver.protocol.titan_m.poller import Poller


class TitanDeviceTask:
    """Diagnostics task *Device* of a Titan-M: byte order and GPS."""

    name = 'Device'

    def __init__(self, reader: PayloadReader[int], gps: Callable[[], str],
                 week_problem: Callable[[], str], stale: Staleness) -> None:
        """Monitor the byte-order detector; callables describe the GPS fix and its week."""
        self._stale = stale
        self._reader = reader
        self._gps = gps
        self._week_problem = week_problem

    def judge(self, now: float) -> Verdict:
        """Return whether answers arrive and can be decoded."""
        if self._stale(now):
            return Verdict(STALE, NO_DATA)
        reader, gps = self._reader, self._gps()
        if reader.held:
            return Verdict(WARN, f'The byte order of payloads is not known yet, {reader.held} '
                                 'answers wait for it: set payload_order if you know it')
        if reader.doubted:
            return Verdict(WARN, f'Answers are read as {reader.order}-endian and make no sense: '
                                 'is payload_order right?')
        problem = self._week_problem()
        if problem:
            return Verdict(WARN, problem)
        return Verdict(WARN if gps == 'no fix' else OK, f'GPS: {gps}')

    def values(self, now: float) -> Mapping[str, str]:
        """Return the detected byte order, the GPS fix and the counts of answers."""
        reader = self._reader
        return {'Payload byte order': reader.order or 'not known yet', 'GPS': self._gps(),
                'Answers held': str(reader.held),
                'Answers dropped unread': str(reader.given_up)}


class TitanHealth:
    """Monitors the answers of a Titan-M."""

    def __init__(self, rates: Mapping[str, float], tolerance: float, stale_timeout: float,
                 poller: Poller | None, reader: PayloadReader[int],
                 gps: Callable[[], str], week_problem: Callable[[], str]) -> None:
        """
        Monitor answers with the given rates by name.

        Without a poller, answers to other programs arrive and none can be lost.
        """
        self._rates = RatesTask(
            rates, tolerance, stale_timeout,
            RequestLosses(lambda: poller.lost_by_name if poller else {}))
        self.tasks: Sequence[Task] = (
            self._rates, TitanDeviceTask(reader, gps, week_problem, self._rates.stale))

    def observe(self, message: Any, now: float) -> None:
        """Update the tasks with a message, received at a monotonic time in seconds."""
        self._rates.observe(message, now)

    def opened(self) -> None:
        """Start a new stream."""
        self._rates.restart()

    def stale(self, now: float) -> bool:
        """Return whether data has stopped, at a monotonic time in seconds."""
        return self._rates.stale(now)

    @property
    def lost(self) -> int:
        """Answers lost since the start."""
        return sum(self._rates.lost.values())

    def device_id(self) -> str:
        """Return nothing: the device reports no identifier."""
        return ''
