# Copyright 2026 The bahrs_driver authors
# SPDX-License-Identifier: Apache-2.0
"""Task *Rates*: whether every message comes as often as it should, and none is lost."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from bahrs_driver.diagnostics.losses import Losses, SequenceLosses
from bahrs_driver.diagnostics.steadiness import Steadiness
from bahrs_driver.diagnostics.task import NO_DATA, OK, STALE, Verdict, WARN
from bahrs_driver.diagnostics.window import Window

RATE_SPAN = 2.0             # s over which a rate is measured
LONGEST_GAP = 0.5           # s; when nothing at all comes for longer, the device has paused


class RatesTask:
    """Counts the messages of a stream, and those that are missing from it."""

    name = 'Rates'

    def __init__(self, expected: Mapping[str, float], tolerance: float, stale_timeout: float,
                 losses: Losses | None = None) -> None:
        """
        Expect messages, by name, at a rate in Hz; 0 is any rate, and none at all.

        A rate may be off by the tolerance (a share); without any of these messages for
        stale_timeout seconds the stream is stale. What is lost is told by sequence numbers
        unless something else knows.
        """
        self._expected = expected
        self._stale_timeout = stale_timeout
        self._received = Counter[str]()
        self._loss_counts = losses or SequenceLosses()
        self._begun = False
        self._last_any: float | None = None
        self._flowing = 0.0         # s, time in which the stream did not pause
        self._last_service: float | None = None
        self._window = Window(self._counts, RATE_SPAN)
        self._steadiness = Steadiness(
            self._counts, list(expected.values()), tolerance, RATE_SPAN)
        self._losses = Window(lambda: [self.lost.get(name, 0) for name in expected])

    @property
    def lost(self) -> Mapping[str, int]:
        """Messages lost since the start, by name."""
        return self._loss_counts.lost

    def observe(self, message: Any, now: float) -> None:
        """Count a message."""
        name = message.NAME
        if name not in self._expected:
            self._notice_service(message, now)
            return
        if self._last_any is not None:
            self._flowing += min(now - self._last_any, LONGEST_GAP)
            if self._last_service is not None and self._last_service > self._last_any:
                self.restart()          # the device was asked to pause
            elif self.stale(now):
                self._begun = False     # that was told, and is no matter of rates
        self._last_any = now
        if not self._begun:
            self._restart_rates()           # they begin with the first message
            self._begun = True
        self._received[name] += 1
        self._loss_counts.observe(message, self._flowing, self._expected[name])

    def restart(self) -> None:
        """Begin to count gaps afresh: the device was switched on, or the port opened again."""
        self._loss_counts.restart()
        self._begun = False
        self._restart_rates()

    def stale(self, now: float) -> bool:
        """Return whether the stream has ended."""
        return self._last_any is None or now - self._last_any > self._stale_timeout

    def judge(self, now: float) -> Verdict:
        """Return whether the stream flows, whole and at its rates."""
        if self.stale(now):
            return self._why_stale(now)
        _, losses = self._losses.growth(now)
        self._window.growth(now)
        wrong = self._steadiness.wrong(now)
        if any(losses):
            return Verdict(WARN, 'Lost just now: ' + _listed(self._expected, losses))
        if wrong:
            expected = list(self._expected.items())
            return Verdict(WARN, ', '.join(
                f'{expected[index][0]} at {rate:.0f} Hz instead of {expected[index][1]:g}'
                for index, rate in wrong.items()))
        return Verdict(OK, 'All messages at their rates')

    def values(self, now: float) -> Mapping[str, str]:
        """Return rate, count and losses of each message."""
        elapsed, counts = self._window.growth(now)
        found = {}
        for (name, rate), count in zip(self._expected.items(), counts):
            measured = count / elapsed if elapsed else 0.0
            found[f'{name} [Hz]'] = f'{measured:.1f}' + (f' of {rate:g}' if rate else '')
            found[f'{name} received'] = str(self._received[name])
            found[f'{name} lost'] = str(self.lost.get(name, 0))
        return found

    def _counts(self) -> list[int]:
        return [self._received[name] for name in self._expected]

    def _restart_rates(self) -> None:
        self._window.restart()
        self._steadiness.restart()

    def _notice_service(self, message: Any, now: float) -> None:
        if message.SERVICE:
            self._last_service = now

    def _why_stale(self, now: float) -> Verdict:
        if self._last_service is not None and now - self._last_service < self._stale_timeout + 6:
            return Verdict(STALE, 'The device is in diagnostics mode; it leaves by itself 5 s '
                                  'after the last request')
        return Verdict(STALE, NO_DATA)


def _listed(names: Mapping[str, float], counts: tuple[int, ...]) -> str:
    return ', '.join(f'{count} {name}' for name, count in zip(names, counts) if count)
