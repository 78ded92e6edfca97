# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Diagnostics of a Titan-M and its answers."""

from collections.abc import Callable, Mapping
from typing import Any

from bahrs_driver.convert.titan_m.gps_status import GpsStatus
from bahrs_driver.diagnostics.losses import RequestLosses
from bahrs_driver.diagnostics.rates_task import RatesTask
from bahrs_driver.diagnostics.stream_health import StreamHealth
from bahrs_driver.diagnostics.task import NO_DATA, OK, Staleness, Status, Template, WARN
from bahrs_driver.protocol.message import Message
from bahrs_driver.protocol.titan_m.byte_order import PayloadDecoder
from bahrs_driver.protocol.titan_m.messages import TitanAnswer
from bahrs_driver.protocol.titan_m.poller import Poller

ORDER_UNKNOWN = Template(WARN, 'The byte order of payloads is not known yet, {held} answers wait '
                               'for it: set payload_order if you know it')
IMPLAUSIBLE = Template(WARN, 'Answers are read as {order}-endian and make no sense: is '
                             'payload_order right?', 'answers read in the wrong byte order')
WRONG_WEEK = Template(WARN, '{problem}', 'an unknown or wrong GPS week')
NO_FIX = Template(WARN, 'GPS: {gps}', 'no fix')
GPS = Template(OK, 'GPS: {gps}')


class TitanDeviceTask:
    """
    Diagnostics task *Device* of a Titan-M: byte order and GPS.

    gps returns the status of the fix, week_problem what is wrong with the GPS week.
    """

    name = 'Device'
    messages = IMPLAUSIBLE, ORDER_UNKNOWN, WRONG_WEEK, NO_FIX, NO_DATA, GPS

    def __init__(self, payloads: PayloadDecoder[Any], gps: Callable[[], GpsStatus],
                 week_problem: Callable[[], str], stale: Staleness) -> None:
        self._stale = stale
        self._payloads = payloads
        self._gps = gps
        self._week_problem = week_problem

    def run(self, status: Status) -> Status:
        """Report whether answers arrive and can be decoded."""
        status.values_from(self._values)
        payloads, gps = self._payloads, self._gps()
        if self._stale(status.now):
            return status.summary(NO_DATA)
        if payloads.held:
            return status.summary(ORDER_UNKNOWN, held=payloads.held)
        if payloads.contradicted:
            return status.summary(IMPLAUSIBLE, order=payloads.order)
        problem = self._week_problem()
        if problem:
            return status.summary(WRONG_WEEK, problem=problem)
        return status.summary(NO_FIX if gps.lacks_fix else GPS, gps=gps)

    def _values(self, _now: float) -> Mapping[str, str]:
        payloads = self._payloads
        return {'Payload byte order': payloads.order or 'not known yet', 'GPS': str(self._gps()),
                'Answers held': str(payloads.held),
                'Answers dropped unread': str(payloads.dropped)}


class TitanHealth(StreamHealth):
    """
    Monitors the answers of a Titan-M, which arrive at the given rates by name.

    Without a poller, answers to other programs arrive and none can be lost.
    """

    def __init__(self, rates: Mapping[str, float], tolerance: float, stale_timeout: float,
                 poller: Poller | None, payloads: PayloadDecoder[Any],
                 gps: Callable[[], GpsStatus], week_problem: Callable[[], str]) -> None:
        task = RatesTask(rates, tolerance, stale_timeout,
                         RequestLosses(lambda: poller.lost_by_name if poller else {}))
        super().__init__(task, TitanDeviceTask(payloads, gps, week_problem, task.stale))
        self._payloads = payloads
        self._released = 0              # answers that were observed before they were decoded

    def observe(self, message: Message, now: float) -> None:
        """Update the tasks with a message, received at a monotonic time in seconds."""
        if isinstance(message, TitanAnswer) and self._released < self._payloads.released:
            self._released += 1         # it was observed undecoded, when it arrived
        else:
            super().observe(message, now)
