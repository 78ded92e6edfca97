# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Requests*: whether a device that is asked answers."""

from collections.abc import Callable, Mapping

from bahrs_driver.diagnostics.task import (
    ERROR, NO_DATA, OK, STALE, Staleness, Verdict, WARN,
)
from bahrs_driver.diagnostics.window import Window
from bahrs_driver.protocol.titan_m.messages import REQUESTS
from bahrs_driver.protocol.titan_m.poller import Poller, UNANSWERED
from bahrs_driver.units import NS_PER_MS

SLOW_NS = 10_000_000        # from a request to its answer, beyond their time on the line


class RequestsTask:
    """Shows the counters of a poller."""

    name = 'Requests'

    def __init__(self, poller: Poller, stale: Staleness, write_error: Callable[[], str]) -> None:
        """
        Watch a poller, and whether its answers have ceased.

        write_error returns why the latest request could not be written; '' if it was.
        """
        self._poller = poller
        self._write_error = write_error
        self._stale = stale
        self._window = Window(lambda: (
            poller.answered.total(), poller.unanswered.total(), poller.unexpected.total(),
            poller.skipped))

    def judge(self, now: float) -> Verdict:
        """Return how the last second went."""
        _, (answered, unanswered, unexpected, skipped) = self._window.growth(now)
        write_error = self._write_error()
        if write_error:
            return Verdict(ERROR, write_error)
        if unanswered >= UNANSWERED and not answered:
            return Verdict(ERROR, 'No request is answered: is the device a titan_m, powered, and '
                                  'is its receiving line connected?')
        if skipped:
            return Verdict(WARN, 'Line, device or host is too slow for the rates asked for: '
                           + ('set the latency timer of the adapter to 1 ms, or '
                              'request.pipelined' if self._slow else
                              'lower state.rate, gps.rate or sensors.rate'))
        if unanswered:
            return Verdict(WARN, f'{unanswered} requests without an answer just now')
        if unexpected:
            return Verdict(WARN, f'{unexpected} answers that came too late or twice just now')
        if self._stale(now):
            return Verdict(STALE, NO_DATA)
        return Verdict(OK, 'All requests answered')

    def values(self, now: float) -> Mapping[str, str]:
        """Return what was counted since the start, and what was learnt."""
        poller = self._poller
        slowest = poller.slowest
        found = {}
        for kind in REQUESTS:
            name = kind.ANSWER.NAME
            found[f'{name} requests'] = str(poller.requests[kind])
            found[f'{name} answered'] = str(poller.answered[kind])
            found[f'{name} unanswered'] = str(poller.unanswered[kind])
            found[f'{name} given up'] = str(poller.lost[kind])
            found[f'{name} too late or twice'] = str(poller.unexpected[kind])
        return {
            **found,
            'Turns left out': str(poller.skipped),
            'Slowest answer [ms]': 'unknown' if slowest is None else f'{slowest / NS_PER_MS:.1f}',
            'Checksum byte order of requests': poller.checksum_order,
            'Message ids come back': 'yes' if poller.returns_ids else 'not seen',
        }

    @property
    def _slow(self) -> bool:
        return (self._poller.slowest or 0) > SLOW_NS
