# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Requests*: whether the device answers requests."""

from collections.abc import Mapping

from bahrs_driver.diagnostics.task import ERROR, NO_DATA, OK, Staleness, Status, Template, WARN
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.protocol.titan_m.messages import REQUESTS
from bahrs_driver.protocol.titan_m.poller import Poller, UNANSWERED
from bahrs_driver.units import NS_PER_MS

SLOW_NS = 10_000_000        # from a request to its answer, without their time on the line

NOT_WRITTEN = Template(ERROR, '{write_error}', 'requests that cannot be written')
NO_ANSWER = Template(ERROR, 'No request is answered: is the device a titan_m, powered, and is its '
                            'receiving line connected?', 'a Titan-M that does not answer')
TOO_SLOW = Template(WARN, 'The line, device or host is too slow for the requested rates: '
                          '{rate_remedy}',
                    'rates that line, device or host cannot keep')
ANSWERS_MISSING = Template(WARN, '{count} requests without an answer just now',
                           'answers lost now and then')
UNEXPECTED = Template(WARN, '{count} answers that came too late or twice just now',
                      'answers that come too late')
ANSWERED = Template(OK, 'All requests answered')
LATENCY_REMEDY = 'set the latency timer of the adapter to 1 ms, or request.pipelined'
RATE_REMEDY = 'lower state.rate, gps.rate or sensors.rate'


class RequestsTask:
    """Reports the counters of a poller; stale returns whether its answers have ceased."""

    name = 'Requests'
    messages = (NOT_WRITTEN, NO_ANSWER, TOO_SLOW, ANSWERS_MISSING, UNEXPECTED, NO_DATA, ANSWERED)

    def __init__(self, poller: Poller, stale: Staleness) -> None:
        self._poller = poller
        self._stale = stale
        self._window = Window(lambda: (
            poller.answered.total(), poller.unanswered.total(), poller.unexpected.total(),
            poller.skipped))

    def run(self, status: Status) -> Status:
        """Report how many requests of the last second were answered."""
        status.values_from(self._values)
        _, (answered, unanswered, unexpected, skipped) = self._window.growth(status.now)
        write_error = self._poller.write_error
        if write_error:
            return status.summary(NOT_WRITTEN, write_error=write_error)
        if unanswered >= UNANSWERED and not answered:
            return status.summary(NO_ANSWER)
        if skipped:
            return status.summary(
                TOO_SLOW, rate_remedy=LATENCY_REMEDY if self._slow else RATE_REMEDY)
        if unanswered:
            return status.summary(ANSWERS_MISSING, count=unanswered)
        if unexpected:
            return status.summary(UNEXPECTED, count=unexpected)
        return status.summary(NO_DATA if self._stale(status.now) else ANSWERED)

    def _values(self, _now: float) -> Mapping[str, str]:
        poller = self._poller
        slowest = poller.slowest
        values = {}
        for kind in REQUESTS:
            name = kind.ANSWER.NAME
            values[f'{name} requests'] = str(poller.requests[kind])
            values[f'{name} answered'] = str(poller.answered[kind])
            values[f'{name} unanswered'] = str(poller.unanswered[kind])
            values[f'{name} given up'] = str(poller.lost[kind])
            values[f'{name} too late or twice'] = str(poller.unexpected[kind])
        return {
            **values,
            'Turns left out': str(poller.skipped),
            'Slowest answer [ms]': 'unknown' if slowest is None else f'{slowest / NS_PER_MS:.1f}',
            'Checksum byte order of requests': poller.checksum_order,
            'Template ids come back': 'yes' if poller.returns_ids else 'not seen',
        }

    @property
    def _slow(self) -> bool:
        return (self._poller.slowest or 0) > SLOW_NS
